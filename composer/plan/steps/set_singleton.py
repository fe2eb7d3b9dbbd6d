"""Step: settings that a model has once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput
from composer.recipe.element import Element
from composer.recipe.recipe import sections_of
from composer.recipe.singleton import Singleton


@dataclass(frozen=True, slots=True)
class SetSingleton(Step):
    """Set attributes of a section that a model has once (`option`, `visual`, …)."""

    sections: ClassVar[tuple[str, ...]] = sections_of(Singleton)
    section: str
    element: Element
    span: Span

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        for section in cls.sections:
            element: Element | None = getattr(given.recipe, section)
            if element is not None:
                yield cls(section, element, given.span(element.at, key=True))

    @property
    def words(self) -> str:
        return f"set {self.section}: {', '.join(_settings(self.element))}"

    @property
    def reason(self) -> str:
        return "set by the recipe"

    @property
    def settled(self) -> Iterator[str]:
        """The paths of the values that are set (`option/cone`)."""
        return _paths(self.element, self.section)


def _settings(element: Element, path: str = "") -> Iterator[str]:
    yield from (f"{path}{name} = {value}" for name, value in element.attributes.items())
    for child in element.children:
        yield from _settings(child, f"{path}{child.tag}.")


def _paths(element: Element, path: str) -> Iterator[str]:
    yield from (f"{path}/{name}" for name in element.attributes)
    for child in element.children:
        yield from _paths(child, f"{path}/{child.tag}")
