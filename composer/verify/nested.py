"""The checks of a recipe and of the recipes in it, each with what it is about in the outermost one's model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from composer.numerics.pose import IDENTITY_QUAT, ORIGIN
from composer.plan.part_record import PartRecord
from composer.plan.plan import BASE, Plan
from composer.recipe.checks.kind import Check


@dataclass(frozen=True, slots=True)
class Nested:
    """A recipe as it is in another: `part` is what that calls it with a separator behind, empty for the outermost.

    `prefix` stands before its names, `others` are prefixes of what is not its own, `keys` stands before the names
    of its keyframes, None where they were left out.
    """

    plan: Plan
    part: str = ""
    prefix: str = ""
    others: tuple[str, ...] = ()
    keys: str | None = ""

    @property
    def whole(self) -> bool:
        """Whether the whole model is its own."""
        return not self.prefix and not self.others

    def scope(self) -> dict[str, object]:
        """The fields of a `kinds.scope.Scope`, as JSON data."""
        return {
            "prefix": self.prefix,
            "others": list(self.others),
            "separator": self.plan.separator,
            "keys": self.keys,
            "whole": self.whole,
        }

    def frame(self, members: Sequence[PartRecord]) -> dict[str, object] | None:
        """Where its world stands in that of the model: a body and the pose in it; None where that is not known.

        The base of a recipe stands in the recipe's own world, so that its place is the recipe's.
        """
        if not self.part:
            return {"body": None, "pos": ORIGIN, "quat": IDENTITY_QUAT}
        end, name, plan = self.plan.separator, f"{self.part}{BASE}", self.plan
        while isinstance(plan.base.model, Plan):
            plan, name = plan.base.model, f"{name}{end}{BASE}"
        for member in members:
            if member.part == name and member.pose is not None:
                return {"body": member.body, "pos": member.pose.pos, "quat": member.pose.quat}
        return None


def checks_in(plan: Plan) -> Iterator[tuple[Nested, Check]]:
    """The checks of a plan, then those of the recipes in it."""
    for place in plan.walk():
        if isinstance(inner := place.model, Plan):
            part = f"{place.part}{inner.separator}" if place.part else ""
            recipe = Nested(inner, part, place.prefix, place.others, place.keys)
            yield from ((recipe, check) for check in inner.checks)
