"""How sections of MJCF are read by the grammar inside of a pydantic model.

Each form of section has a class, which annotates a field of the recipe: `sensor: Annotated[tuple[Element, ...],
Typed("sensor")]`. Therefore 170 kinds of elements have types without 170 models.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.suggest import advised, exists_note
from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType
from composer.recipe.fault import Fault, Path
from composer.recipe.form import Form
from composer.recipe.reader import Reader
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of


@dataclass(frozen=True, slots=True)
class Section(Form):
    """The base class of all forms of sections."""

    tag: str

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        return self.content(Reader(settings, faults), value)

    @abstractmethod
    def content(self, reader: Reader, value: Any) -> Any:
        """Return the content of the section. Faults are added to the reader."""

    @property
    def kind(self) -> ElementType:
        return GRAMMAR.section(self.tag)

    def tags(self, reader: Reader, value: Any) -> list[tuple[ElementType, Any, Path]]:
        """Return the entries of a mapping from tags to elements."""
        if not isinstance(value, dict):
            message = f"`{self.tag}` expects a mapping from tags to elements, got {kind_of(value)}"
            help = (
                "write the tag as a key: `TAG: …`, not as an item of a list"
                if isinstance(value, list)
                else None
            )
            reader.faults.append(Fault("wrong-type", message, help=help))
            return []
        known: list[tuple[ElementType, Any, Path]] = []
        for tag, item in value.items():
            if tag in self.kind.children:
                known.append((self.kind.children[tag], item, (tag,)))
            else:
                reader.faults.append(
                    self.unknown(tag, (tag,), f"`{self.tag}` has no element `{tag}`", key=True)
                )
        return known

    def unknown(self, tag: str, at: Path, message: str, key: bool) -> Fault:
        """Return the fault of a tag that the section does not have."""
        help, fix = advised(tag, self.kind.children)
        note = exists_note(f"{self.tag} element", self.kind.children, tag)
        return Fault("unknown-element", message, at, key=key, notes=(note,), help=help, fix=fix)


@dataclass(frozen=True, slots=True)
class Elements(Section):
    """Base class of sections that are read as a tuple of `Element`.

    Each element is appended to the section of the model.
    """
