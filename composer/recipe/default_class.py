"""The section `default`: default classes."""

from __future__ import annotations

from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.suggest import advised, exists_note
from composer.grammar import GRAMMAR
from composer.recipe.element import Element
from composer.recipe.element_schema import by_name, mapping
from composer.recipe.fault import Fault, Path
from composer.recipe.raw import path_of
from composer.recipe.reader import Reader
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.section import Section
from composer.recipe.shown import kind_of

PARENT = "parent"


@dataclass(frozen=True, slots=True)
class DefaultClass:
    """A default class. `element` is its `<default>` with the settings as children; `parent` is the written one.

    The place of the name is `locate(node, element.at, key=True)`.
    """

    name: str
    parent: str | None
    element: Element


@dataclass(frozen=True, slots=True)
class Defaults(Section):
    """Form of a mapping from classes to settings by tag: `finger: {parent: collision, geom: {friction: 1}}`.

    It is read as a tuple of `DefaultClass`.
    """

    def content(self, reader: Reader, value: Any) -> tuple[DefaultClass, ...]:
        read = [self._class(reader, name, item) for name, item in reader.names(value, (), "`default`")]
        return tuple(each for each in read if each is not None)

    def schema(self) -> Schema:
        return by_name(reference("class"))

    def _class(self, reader: Reader, name: str, value: Any) -> DefaultClass | None:
        owner = f"class `{name}`"
        if not isinstance(value, dict):
            message = f"{owner} expects a mapping from tags to settings, got {kind_of(value)}"
            reader.faults.append(Fault("wrong-type", message, (name,)))
            return None
        parent: str | None = None
        rows: list[Element] = []
        for tag, item in value.items():
            at = (name, tag)
            if tag == PARENT:
                parent = self._parent(reader, name, item, at=at)
            elif tag == self.tag:
                help = "write the class beside this one, with `parent`"
                message = f"a class cannot stand in {owner}"
                reader.faults.append(Fault("unknown-element", message, at, key=True, help=help))
            elif tag in self.kind.children:
                row = reader.element(self.kind.children[tag], item, at, f"`{tag}` of {owner}")
                rows += [row] if row is not None else []
            else:
                reader.faults.append(self._unknown_row(tag, name, at))
        return DefaultClass(name, parent, Element(self.tag, children=tuple(rows), at=path_of(value)))

    def _parent(self, reader: Reader, name: str, value: Any, at: Path) -> str | None:
        if not isinstance(value, str) or not value:
            message = f"`parent` of class `{name}` expects the name of a class, got {kind_of(value)}"
            reader.faults.append(Fault("wrong-type", message, at))
            return None
        if name == "main":
            message = "`main` is the top class and has no parent"
            reader.faults.append(Fault("class-clash", message, at, key=True, help="leave `parent` out"))
        elif name == value:
            message = f"class `{name}` is its own parent"
            reader.faults.append(Fault("class-clash", message, at, help="write the name of another class"))
        return value

    def _unknown_row(self, tag: str, name: str, at: Path) -> Fault:
        tags = [each for each in self.kind.children if each != self.tag]
        help, fix = advised(tag, [*tags, "parent"])
        note = exists_note("element", tags, tag)
        if name in tags and help is None:
            help = f"the key is the name of a class; for all elements write `main: {{{name}: {{{tag}: …}}}}`"
        return Fault(
            "unknown-element",
            f"`{tag}` has no defaults in class `{name}`",
            at,
            key=True,
            notes=(note,),
            help=help,
            fix=fix,
        )


@definition("class")
def _definition_of_class(_: str) -> Schema:
    rows = {
        tag: reference(f"element:{row.path}")
        for tag, row in GRAMMAR.section("default").children.items()
        if tag != "default"
    }
    parent = {
        "type": "string",
        "minLength": 1,
        "description": "the class that it descends from; without it, the top class",
    }
    return mapping({PARENT: parent, **rows})
