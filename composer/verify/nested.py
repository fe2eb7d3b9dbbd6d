"""The checks of a recipe and of the recipes in it, each with what it is about in the outermost one's model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from composer.numerics.pose import IDENTITY_QUAT, ORIGIN
from composer.plan.part_record import PartRecord
from composer.plan.parts import BASE, called
from composer.plan.plan import Plan
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

    def checks(self) -> Iterator[tuple[Nested, Check]]:
        """Its checks, then those of the recipes in it."""
        for check in self.plan.checks:
            yield self, check
        for inner in self.inner():
            yield from inner.checks()

    def inner(self) -> Iterator[Nested]:
        """The recipes that are its base and its parts."""
        plan, end = self.plan, self.plan.separator
        base = plan.base.model
        if isinstance(base, Plan):
            others = tuple(self.prefix + part.prefix for part in plan.parts if part.prefix)
            keys = None if plan.base.keyframes == "none" else self.keys
            yield Nested(base, f"{self.part}{BASE}{end}", self.prefix, self.others + others, keys)
        for part in plan.parts:
            if isinstance(part.model, Plan):
                policy, keys = part.attachment.keyframes, self.keys
                if policy == "none" or keys is None:
                    keys = None
                elif policy == "prefix":
                    keys += part.prefix
                yield Nested(
                    part.model,
                    f"{self.part}{called(part, end)}{end}",
                    self.prefix + part.prefix,
                    self.others,
                    keys,
                )

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
