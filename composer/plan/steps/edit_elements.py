"""Step: an entry of `edit`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput
from composer.recipe.edit import Edit


@dataclass(frozen=True, slots=True)
class EditElements(Step):
    """Change the selected elements, in the whole model or in one part."""

    sections: ClassVar[tuple[str, ...]] = ("edit",)
    edit: Edit
    span: Span

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        for edit in given.recipe.edit:
            yield cls(edit, given.span(edit.at))

    @property
    def words(self) -> str:
        return self.edit.words

    @property
    def reason(self) -> str:
        return self.words
