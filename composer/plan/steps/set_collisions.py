"""Step: which parts may touch."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput
from composer.recipe.contact import Collisions


@dataclass(frozen=True, slots=True)
class SetCollisions(Step):
    """Exclude contacts between bodies, or make geoms collide."""

    sections: ClassVar[tuple[str, ...]] = ()
    collisions: Collisions
    span: Span

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        for each in given.recipe.contact:
            if isinstance(each, Collisions):
                yield cls(each, given.span(each.at))

    @property
    def words(self) -> str:
        if self.collisions.samples is not None:
            drawn = f"{self.collisions.samples} samples, seed {self.collisions.seed}"
            return f"exclude contacts between bodies that need not collide ({drawn})"
        if not self.collisions.sides:
            return "exclude contacts between bodies of different parts that touch"
        one, other = (", ".join(side) for side in self.collisions.sides)
        if self.collisions.what == "exclude":
            return f"exclude contacts between {one} and {other}"
        return f"let {one} and {other} collide"

    @property
    def reason(self) -> str:
        return self.words
