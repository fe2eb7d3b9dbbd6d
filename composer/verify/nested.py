"""The checks of a recipe and its nested recipes, each with its scope in the outermost model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from composer.dataclass import dataclass
from composer.numerics.pose import IDENTITY_QUAT, ORIGIN
from composer.plan.part_record import PartRecord
from composer.plan.plan import BASE, Plan
from composer.recipe.checks.kind import Check


@dataclass(frozen=True, slots=True)
class Nested:
    """A recipe within another one.

    `part` is its name there with a separator behind it, empty for the outermost recipe. `prefix` starts all its
    names, `others` are longer prefixes that do not belong to it, and `keys` starts the names of its keyframes; None
    if they were left out.
    """

    plan: Plan
    part: str = ""
    prefix: str = ""
    others: tuple[str, ...] = ()
    keys: str | None = ""

    @property
    def whole(self) -> bool:
        """Whether the whole model belongs to the recipe."""
        return not self.prefix and not self.others

    def scope(self) -> dict[str, object]:
        """Return the fields of a `kinds.scope.Scope` as JSON data."""
        return {
            "prefix": self.prefix,
            "others": list(self.others),
            "separator": self.plan.separator,
            "keys": self.keys,
            "whole": self.whole,
        }

    def frame(self, members: Sequence[PartRecord]) -> dict[str, object] | None:
        """Return the body and pose of its world in the model, or None if the pose is unknown.

        The base of a recipe is placed at the origin of the recipe's world, so the place of the base is that
        of the recipe.
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
    """Yield the checks of a plan, then those of its nested recipes."""
    for place in plan.walk():
        if isinstance(inner := place.model, Plan):
            part = f"{place.part}{inner.separator}" if place.part else ""
            recipe = Nested(inner, part, place.prefix, others=place.others, keys=place.keys)
            yield from ((recipe, check) for check in inner.checks)
