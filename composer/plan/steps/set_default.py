"""Step: a default class."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput
from composer.recipe.element import Element


@dataclass(frozen=True, slots=True)
class SetDefault(Step):
    """Set a default class, creating it if it does not exist."""

    sections: ClassVar[tuple[str, ...]] = ("default",)
    name: str
    parent: str | None
    element: Element
    span: Span

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        for each in given.recipe.default:
            yield cls(each.name, each.parent, each.element, given.span(each.element.at, key=True))

    @property
    def words(self) -> str:
        return f"set the default class {self.name}: {', '.join(child.tag for child in self.element.children)}"

    @property
    def reason(self) -> str:
        return "set by the recipe"
