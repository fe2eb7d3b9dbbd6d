"""Sections by tag: named elements (`asset`, `custom`, `deformable`) and lists (`contact`)."""

from __future__ import annotations

from typing import Any

from composer.dataclass import dataclass
from composer.grammar.element import ElementType
from composer.recipe.element import Element
from composer.recipe.element_schema import by_name, described, mapping
from composer.recipe.fault import Fault, Path
from composer.recipe.reader import NAME, Reader
from composer.recipe.reference import Schema, reference
from composer.recipe.section import Elements
from composer.recipe.shown import kind_of


@dataclass(frozen=True, slots=True)
class ByTag(Elements):
    """Form of a mapping from tags to mappings from names to elements: `asset`, `custom`, `deformable`.

    It is read as a tuple of `Element`, each with its name as an attribute.
    """

    def content(self, reader: Reader, value: Any) -> tuple[Element, ...]:
        read = [
            self.element(reader, kind, name, value=item, at=(*at, name))
            for kind, items, at in self.tags(reader, value)
            for name, item in reader.names(items, at, f"`{kind.tag}` in `{self.tag}`")
        ]
        return tuple(element for element in read if element is not None)

    def schema(self) -> Schema:
        kinds = self.kind.children.values()
        return mapping(
            {kind.tag: described(by_name(reference(f"named:{kind.path}")), kind.doc) for kind in kinds}
        )

    def element(self, reader: Reader, kind: ElementType, name: str, value: Any, at: Path) -> Element | None:
        owner = f"{kind.tag} `{name}`"
        keyed = reader.keyed([kind], name, value, at=at, owner=owner)
        return reader.element(kind, value, at, owner, keyed=keyed, own=() if keyed else (NAME,))


@dataclass(frozen=True, slots=True)
class Lists(Elements):
    """Form of a mapping from tags to lists of elements: `contact`. It is read as a tuple of `Element`."""

    def content(self, reader: Reader, value: Any) -> tuple[Element, ...]:
        elements: list[Element] = []
        for kind, items, at in self.tags(reader, value):
            if not isinstance(items, list):
                message = f"`{kind.tag}` in `{self.tag}` expects a list, got {kind_of(items)}"
                help = f"write `{kind.tag}: [{{…}}]`" if isinstance(items, dict) else None
                reader.faults.append(Fault("wrong-type", message, at, help=help))
                continue
            elements += reader.children(kind, items, at, owner=f"`{self.tag}`")
        return tuple(elements)

    def schema(self) -> Schema:
        kinds = self.kind.children.values()
        return mapping(
            {
                kind.tag: described({"type": "array", "items": reference(f"element:{kind.path}")}, kind.doc)
                for kind in kinds
            }
        )
