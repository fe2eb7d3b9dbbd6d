"""Answer a query about a model: compose it again under observation, and read the answer off the record."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.collect import collect
from composer.compose.compose import Composer
from composer.context import Context
from composer.explain import query
from composer.explain.explanation import (
    Explained,
)
from composer.explain.trace import Trace
from composer.explain.traced import Traced
from composer.link.measure import measure_with
from composer.link.source_check import check_source
from composer.plan.allowed import acknowledge
from composer.plan.concrete import Given
from composer.plan.drawn_parameters import check_sample
from composer.plan.planner import make_plan
from composer.tree.parse import parse_file

if TYPE_CHECKING:
    pass


def explain(
    path: Path, asked: query.Asked, context: Context, sample: int = 0, given: Given | None = None
) -> Explained | None:
    """Return the answer to a query about the model of a recipe or an MJCF file, or None after an error.

    Errors go to `context.sink`. `sample` selects the draws of the model; 0 is the nominal one. `given` are values
    of parameters and variants.
    """
    traced = trace(path, context, sample, given=given)
    return None if traced is None else traced.answer(asked, context)


def trace(path: Path, context: Context, sample: int = 0, given: Given | None = None) -> Traced | None:
    """Compose the model under observation. Compiles only parts that MuJoCo has to measure."""
    watch = Trace()
    if path.suffix.lower() == ".xml":
        for node in (given or {}).values():
            message = f"`{context.shown(context.folder / path)}` is not a recipe and has no parameters"
            context.sink.error("unknown-name", message, node.span)
        if given:
            return None
        unit = parse_file(context.folder / path, context.sink, file=context.shown(context.folder / path))
        if unit is None or not check_source(unit, context.sink):
            return None
        watch([unit], path)
        return Traced(unit, watch, "/", folder=context.folder)
    if path.suffix.lower() in (".zip", ".mjz", ".mjb") or os.path.isdir(context.folder / path):
        _no_recipe(path, context)
        return None
    plan = make_plan(path, context, given, sample=sample)
    if plan is not None and not check_sample(plan, sample, context.sink):
        return None
    composed = None if plan is None else Composer(context, measure_with(context), watch=watch).compose(plan)
    if plan is not None:
        acknowledge(plan, context.sink, context.shown, whole=False)
    if plan is None or composed is None:
        return None
    collect(composed.model, composed.files, context.sink, shown=context.shown)
    watch([composed.model], collect)
    return Traced(composed.model, watch, plan.separator, folder=context.folder)


def _no_recipe(path: Path, context: Context) -> None:
    """Report that a bundle has neither its recipe nor the files of its parts."""
    from composer.bundle.bundle import MANIFEST
    from composer.bundle.manifest import from_json
    from composer.bundle.read import ReadError, read

    recipe = None
    try:
        if (content := read(context.folder / path).files.get(MANIFEST)) is not None:
            recipe = from_json(content).recipe
    except (ReadError, ValueError):
        pass
    built = f"`mjcompose explain {recipe.path}`" if recipe is not None else "the recipe that it was built of"
    context.sink.error(
        "source-kind",
        f"`{context.shown(context.folder / path)}` has the model as it is, not where its elements came from",
        help=f"ask the recipe: {built}" if recipe is not None else f"ask {built}",
    )
