"""Parts that checks and keyframes name: they must be there."""

from __future__ import annotations

from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import closest
from composer.diagnostics.unknown import unknown_name
from composer.document.node import locate
from composer.plan.plan import Plan
from composer.recipe.checks.unchanged import Unchanged
from composer.recipe.keyframe import FROM


def check_part_names(plan: Plan, sink: Sink) -> None:
    """Tell those that are no parts of the recipe, or may be two."""
    parts = list(plan.part_names)
    _of_checks(plan, parts, sink)
    _of_keys(plan, parts, sink)


def _of_checks(plan: Plan, parts: list[str], sink: Sink) -> None:
    """What a check is about must be a part."""
    for check in plan.checks:
        if not isinstance(check, Unchanged) or check.part is None or check.part in parts:
            continue
        near = closest(check.part, parts)
        sink.add(
            unknown_name(
                "part",
                check.part,
                parts,
                locate(plan.document, (*check.at, "unchanged", "part")),
                message=f"check `{check.name}` is about `{check.part}`, which is not a part of this recipe",
                help=f"write `part: {near[0]}`" if near else None,
                about=(check.name,),
            )
        )


def _of_keys(plan: Plan, parts: list[str], sink: Sink) -> None:
    """Tell parts that keys are to be made of and that are not there."""
    for step in plan.keyframes:
        for part in step.key.sources:
            if parts.count(part) > 1:
                sink.error(
                    "name-clash",
                    f"`{part}` may be two parts: one has it as its prefix, and one without a prefix as its key",
                    locate(plan.document, (*step.key.at, FROM, part), key=True),
                    help="give the one without a prefix another key",
                    subjects=(part,),
                )
            elif part not in parts:
                span = locate(plan.document, (*step.key.at, FROM, part), key=True)
                sink.add(unknown_name("part", part, parts, span, purpose=" to take a key from"))
