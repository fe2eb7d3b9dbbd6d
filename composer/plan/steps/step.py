"""The base class of all types of steps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.document.node import Mapping, locate
from composer.recipe.element import Element
from composer.recipe.fault import Path
from composer.recipe.randomize import Randomize
from composer.recipe.recipe import Recipe


@dataclass(frozen=True, slots=True)
class StepInput:
    """The input of steps: a recipe, its document, its draws and the sample."""

    recipe: Recipe
    document: Mapping
    randomize: Randomize | None
    sample: int

    def span(self, at: Path, key: bool = False) -> Span:
        """Return the place of a value in the recipe, or of its key."""
        return locate(self.document, at, key=key)


class Step(ABC):
    """One thing that a recipe writes. A type of step is a frozen dataclass with a `span`, and a row in `table.py`.

    `sections` are the top-level keys of a recipe that steps of this type carry out.
    """

    __slots__ = ()
    sections: ClassVar[tuple[str, ...]]
    span: Span

    @classmethod
    @abstractmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        """Yield the steps of this type in a recipe, in the order in which they are carried out."""

    @property
    @abstractmethod
    def words(self) -> str:
        """The line that `plan` prints for the step."""

    @property
    @abstractmethod
    def reason(self) -> str:
        """The reason that `explain` gives for an element or attribute written by the step."""


def words_of_element(element: Element) -> str:
    """Return the name of an element in the words of a step.

    >>> words_of_element(Element("geom")), words_of_element(Element("site", {"name": "tip"}))
    ('a geom', 'site tip')
    """
    name = element.attributes.get("name")
    article = "an" if element.tag[0] in "aeiou" else "a"
    return f"{element.tag} {name}" if name is not None else f"{article} {element.tag}"
