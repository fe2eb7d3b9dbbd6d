"""What a recipe calls its parts, and the parts of these."""

from __future__ import annotations

from collections.abc import Iterator

from composer.plan.plan import AttachPart, Plan

BASE = "base"


def called(part: AttachPart, separator: str) -> str:
    """A part of the recipe: its prefix, or its key where it has none."""
    return part.prefix.removesuffix(separator) or str(part.at[-1])


def parts_of(plan: Plan) -> Iterator[str]:
    """Everything that is a part of a recipe, with the path to it: `base`, `left`, `left/gripper`."""
    pieces = [(BASE, plan.base.model), *((called(part, plan.separator), part.model) for part in plan.parts)]
    for name, model in pieces:
        if model is not None:
            yield name
        if isinstance(model, Plan):
            yield from (f"{name}{plan.separator}{inner}" for inner in parts_of(model))
