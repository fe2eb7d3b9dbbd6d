"""Step: an element under a body, a frame or the world."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput, words_of_element
from composer.recipe.element import Element


@dataclass(frozen=True, slots=True)
class AddElement(Step):
    """Add an element to a body, a frame or the world (`to_kind` world, body, frame)."""

    sections: ClassVar[tuple[str, ...]] = ("add",)
    to_kind: Literal["world", "body", "frame"]
    to: str
    element: Element
    to_span: Span
    span: Span

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        for item in given.recipe.add:
            path = (*item.at, "to", "frame") if item.to_kind == "frame" else (*item.at, "to")
            spans = given.span(path), given.span(item.element.at)
            yield cls(item.to_kind, item.to, item.element, *spans)

    @property
    def words(self) -> str:
        where = "the world" if self.to_kind == "world" else f"the {self.to_kind} {self.to}"
        return f"add {words_of_element(self.element)} to {where}"

    @property
    def reason(self) -> str:
        return "added by the recipe"
