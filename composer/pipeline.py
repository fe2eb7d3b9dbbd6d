"""From a recipe to a verified bundle: the stages in order. Each takes what the one before it gives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.assemble import assemble, described
from composer.bundle.bundle import Bundle
from composer.context import Context
from composer.link.dedup import Merged, dedup
from composer.plan.make import plan_what_remains
from composer.plan.plan import Plan
from composer.steps.compose import Composed, Composer
from composer.steps.measure import measure_with
from composer.verify.judged import judge

if TYPE_CHECKING:
    from composer.engine import Compiled, Limits


@dataclass(frozen=True, slots=True)
class Built:
    """What a build gives; `compiled` is None where nothing was verified, `merged` empty where nothing was merged."""

    plan: Plan
    composed: Composed
    bundle: Bundle
    compiled: Compiled | None
    merged: Merged


def build(
    recipe: Path,
    context: Context,
    *,
    verified: bool = True,
    deduplicated: bool = False,
    limits: Limits | None = None,
) -> Built | None:
    """The bundle of a recipe, nothing written yet; None where `context.sink` has errors."""
    if (plan := plan_what_remains(recipe, context)) is None:
        return None
    if (composed := Composer(context, measure_with(context, limits), limits).compose(plan)) is None:
        return None
    merged: Merged = {}
    if deduplicated:
        merged, files = dedup(composed.model, composed.files, plan.prefixes)
        composed = replace(composed, files=files)
    if (bundle := assemble(plan, composed.model, composed.files, context)) is None:
        return None
    compiled = judge(bundle, composed.model, context, limits) if verified else None
    if context.sink.has_errors:
        return None
    return Built(plan, composed, described(bundle, plan, compiled, context, merged), compiled, merged)
