"""Step: an element of a section whose elements form a list."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput, words_of_element
from composer.recipe.element import Element
from composer.recipe.recipe import sections_of
from composer.recipe.section import Elements


@dataclass(frozen=True, slots=True)
class AppendElement(Step):
    """Append an element to a section."""

    sections: ClassVar[tuple[str, ...]] = sections_of(Elements)
    section: str
    element: Element
    span: Span

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        for section in cls.sections:
            for element in getattr(given.recipe, section):
                if isinstance(element, Element):
                    yield cls(section, element, given.span(element.at, key=True))

    @property
    def words(self) -> str:
        return f"add {words_of_element(self.element)} to {self.section}"

    @property
    def reason(self) -> str:
        return "written in the recipe"
