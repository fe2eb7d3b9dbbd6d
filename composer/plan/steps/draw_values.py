"""Step: a field of `randomize`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput
from composer.recipe.draw_field import DrawField


@dataclass(frozen=True, slots=True)
class DrawValues(Step):
    """Draw the values of a field for a sample; for sample 0, which has no draws, check those of all other samples."""

    sections: ClassVar[tuple[str, ...]] = ("randomize",)
    field: DrawField
    seed: int
    sample: int
    samples: int
    span: Span
    tabled: bool = False

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        randomize = given.randomize
        for field in randomize.fields if randomize is not None else ():
            if randomize is not None and field.select is not None:
                span = given.span(field.drawn_at)
                tabled = randomize.at_run_time
                yield cls(field, randomize.seed, given.sample, randomize.samples, span, tabled)

    @property
    def words(self) -> str:
        return self.field.words

    @property
    def reason(self) -> str:
        return f"{self.words}, sample {self.sample}"
