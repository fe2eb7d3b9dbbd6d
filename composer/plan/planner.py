"""A recipe to a plan: references resolved, nested recipes planned, every step in its order."""

from __future__ import annotations

import os
from collections.abc import Iterator
from collections.abc import Mapping as Map
from dataclasses import replace
from pathlib import Path

from composer.context import Context, as_text
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.span import Span
from composer.document.node import Mapping, find, locate
from composer.expand.expand import Concrete
from composer.plan.angle_context import Reading, Readings, check_bare_angles, readings_of
from composer.plan.concrete import Given, validated
from composer.plan.drawn import Drawn
from composer.plan.drawn_parameters import drawn_parameters
from composer.plan.locked import use_lock
from composer.plan.matrix import read_matrix
from composer.plan.parts import check_part_names, copies, in_order, without_rings
from composer.plan.pieces import check_pieces
from composer.plan.plan import AttachPart, LoadBase, Plan
from composer.plan.read import folder_of
from composer.plan.steps.set_singleton import SetSingleton
from composer.plan.steps.step import Written
from composer.plan.steps.table import steps_of
from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.draw_field import DrawField
from composer.recipe.recipe import Recipe
from composer.sources.error import SourceError
from composer.sources.resolve import resolve
from composer.sources.source import Source


def make_plan(
    recipe: Path, context: Context, given: Given | None = None, sample: int = 0, name: str | None = None
) -> Plan | None:
    """What a build of the recipe will do; None where it or what it refers to is at fault.

    `name` and `sample` are as in `plan_what_remains`.
    """
    before = context.sink.error_count
    plan = plan_what_remains(recipe, context, given, name, sample)
    return plan if context.sink.error_count == before else None


def plan_what_remains(
    recipe: Path, context: Context, given: Given | None = None, name: str | None = None, sample: int = 0
) -> Plan | None:
    """The plan without what is at fault, in which later stages can look for more; None without a base.

    `name` is that of a cell of the matrix; without it, the recipe's own, and the matrix is looked at too. `sample`
    counts the draws, 0 has none.
    """
    if use_lock(recipe, context) is None:
        return None
    path = context.folder / recipe
    plan = _Planner(context).plan(path, (), given=given or {}, name=name, sample=sample)
    if name is None and plan is not None:
        matrix = read_matrix(path, context, given)
        if matrix is not None:
            check_pieces(matrix.document, given or {}, context.sink)
            if matrix.cells:
                plan = replace(plan, cells=len(matrix.cells), cells_at=matrix.cells[0].span)
    return plan


class _Planner:
    def __init__(self, context: Context) -> None:
        self.context = context
        self.sink = context.sink

    def plan(
        self,
        path: Path,
        outer: tuple[tuple[Path, Span | None], ...],
        span: Span | None = None,
        *,
        given: Given,
        name: str | None = None,
        sample: int = 0,
        source: Source | None = None,
    ) -> Plan | None:
        """The plan of one recipe; `outer` are the recipes it is nested in, outermost first."""
        key = Path(os.path.realpath(path))
        if any(each == key for each, _ in outer):
            ring = [each.name for each, _ in outer[[each for each, _ in outer].index(key) :]]
            self.sink.error(
                "source-cycle",
                "recipes contain one another: " + " → ".join([*ring, path.name]),
                span,
                help="a recipe cannot be a part of itself: take one of these references out",
            )
            return None
        read = self._read(path, given)
        if read is None:
            return None
        recipe, document, concrete = read
        randomize = recipe.randomize if not outer else None
        drawn: tuple[Drawn, ...] = ()
        if randomize is not None and randomize.emit == "table":
            for field in randomize.of_parameters:
                self._no_table(field, document)
        elif randomize is not None and randomize.of_parameters and concrete is not None:
            values, drawn = drawn_parameters(randomize, sample, concrete, document, self.sink)
            if values:
                read = self._read(path, {**given, **values})
                if read is None:
                    return None
                recipe, document, concrete = read
                randomize = recipe.randomize
        inside = (*outer, (key, span))
        base = self._base(recipe, document, inside)
        parts = without_rings(tuple(self._parts(recipe, document, inside)), recipe.separator, self.sink)
        if base is None:
            return None
        readings = self._readings(path, recipe, document, concrete)
        steps = tuple(steps_of(Written(recipe, document, randomize, sample)))
        plan = Plan(
            name=name or recipe.name or as_text(path.stem),
            description=recipe.description,
            path=path,
            file=self.context.shown(path),
            document=document,
            separator=recipe.separator,
            conflict=recipe.conflict,
            readings=readings,
            base=base,
            parts=parts,
            steps=steps,
            settled=frozenset(
                path for step in steps if isinstance(step, SetSingleton) for path in step.settled
            ),
            scope=concrete.scope if concrete else {},
            variants=concrete.variants if concrete else {},
            checks=recipe.check,
            randomize=randomize,
            sample=sample,
            drawn=drawn,
            source=source,
            extended=self.context.recipes[path].extended,
        )
        check_part_names(plan, self.sink)
        return plan

    def _no_table(self, field: DrawField, document: Mapping) -> None:
        self.sink.error(
            "draw-at-run-time",
            f"field `{field.name}` draws a parameter, which a model that is compiled does not have any more",
            locate(document, (*field.at, "param")),
            help="write `emit: models`, which builds every sample",
            subjects=(field.name,),
        )

    def _read(self, path: Path, given: Given) -> tuple[Recipe, Mapping, Concrete | None] | None:
        found = validated(path, given, self.context)
        if found is None:
            return None
        self.sink.suppress_about(found.lost)
        return found.recipe, found.document, found.concrete

    def _readings(self, path: Path, recipe: Recipe, document: Mapping, concrete: Concrete | None) -> Readings:
        """How bare angles are read: in a file that says nothing, as nothing."""
        whole = Reading(recipe.angle, recipe.eulerseq)
        files = self.context.recipes[path].said
        if concrete is None or len(files) < 2:
            return Readings(document, whole)
        readings = readings_of(concrete, document, whole, files, self.sink)
        check_bare_angles(readings, self.sink)
        return readings

    def _base(
        self, recipe: Recipe, document: Mapping, inside: tuple[tuple[Path, Span | None], ...]
    ) -> LoadBase | None:
        if recipe.base is None:
            return LoadBase(None, "merge", None)
        span = locate(document, ("base", "model"))
        model = self._model(recipe.base, ("base",), document, inside, recipe)
        if model is None:
            return None
        base = recipe.base
        return LoadBase(model, base.keyframes, span, base.subtree, base.drop, base.edit)

    def _parts(
        self, recipe: Recipe, document: Mapping, inside: tuple[tuple[Path, Span | None], ...]
    ) -> Iterator[AttachPart]:
        taken: dict[str, Span] = {}
        for key in in_order(recipe.attach, document, self.sink):
            attachment = recipe.attach[key]
            at = ("attach", key)
            span = locate(document, at, key=True)
            name = key if attachment.prefix is None else attachment.prefix
            numbered = [(name + suffix, copy) for suffix, copy in copies(attachment.replicate)]
            prefixes = {own + recipe.separator if own else "": copy for own, copy in numbered}
            clash = next((prefix for prefix in prefixes if prefix and prefix in taken), None)
            if clash is not None:
                self.sink.error(
                    "name-clash",
                    f"two parts have the prefix `{clash}`",
                    span if attachment.prefix is None else locate(document, (*at, "prefix")),
                    notes=(Note("the other part", taken[clash]),),
                    help="give one of them another key, or another `prefix`",
                    subjects=(clash,),
                )
                continue
            taken.update(dict.fromkeys(prefixes, span))
            model = self._model(attachment, at, document, inside, recipe)
            if model is None:
                self.sink.suppress_about(own for own, _ in numbered)
            else:
                for prefix, copy in prefixes.items():
                    yield AttachPart(prefix, model, attachment, at, span, copy)

    def _model(
        self,
        asked: Base | Attachment,
        at: tuple[str | int, ...],
        document: Mapping,
        inside: tuple[tuple[Path, Span | None], ...],
        outer: Recipe,
    ) -> Source | Plan | None:
        """What the mapping at `at` asks for: a source, or the plan of a nested recipe."""
        span = locate(document, (*at, "model"))
        folder = folder_of(span, self.context)
        try:
            source = resolve(
                asked.model,
                relative_to=folder,
                environment=self.context.environment,
                fetching=self.context.fetching,
            )
        except SourceError as error:
            self.sink.add(error.at(span))
            return None
        given = find(document, (*at, "with"))
        if asked.packages and source.format != "urdf":
            self._only_for("packages", "URDF", asked.model, document, at)
        if source.format == "recipe":
            values = (
                {name: value for name, (_, value) in given.entries.items()}
                if isinstance(given, Mapping)
                else {}
            )
            plan = self.plan(source.path, inside, span, given=values, source=source)
            if plan is not None and plan.separator != outer.separator:
                self.sink.error(
                    "separator-mismatch",
                    f"`{asked.model}` separates names with `{plan.separator}`, this recipe with `{outer.separator}`",
                    span,
                    help=f'give both the same: `separator: "{plan.separator}"`',
                )
            return plan
        if given is not None:
            self._only_for("with", "recipes", asked.model, document, at)
        if not asked.packages or source.format != "urdf":
            return source
        return replace(source, packages=tuple(self._packages(asked.packages, document, at)))

    def _only_for(
        self, key: str, what: str, model: str, document: Mapping, at: tuple[str | int, ...]
    ) -> None:
        self.sink.error(
            "unknown-key",
            f"`{key}` is for {what}, and `{model}` is not one",
            locate(document, (*at, key), key=True),
            help=f"take `{key}` out",
            subjects=(key,),
        )

    def _packages(
        self, packages: Map[str, str], document: Mapping, at: tuple[str | int, ...]
    ) -> Iterator[tuple[str, Path]]:
        """The folders of the packages that a URDF refers to."""
        for name, written in packages.items():
            span = locate(document, (*at, "packages", name))
            folder = folder_of(span, self.context) / written
            if not folder.is_dir():
                self.sink.error(
                    "file-not-found",
                    f"the folder of the package `{name}` does not exist: `{self.context.shown(folder)}`",
                    span,
                    help="the path is relative to the recipe, and leads to the folder that `package://"
                    f"{name}` stands for",
                )
            yield name, folder
