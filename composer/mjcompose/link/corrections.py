"""Entries of a part, for its `drop` or `edit`, that correct a file which is not valid alone.

Files of robosuite, for example, are joined by a program that reads XML: a mesh that two files declare, an attribute
that MJCF does not have, and a material of another file do not matter to it. The help lines of errors show these
entries, and `mjcompose import` writes them into a recipe.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.tree.classes import MAIN, given
from mjcompose.tree.edit import can_do_without, is_section
from mjcompose.tree.grammar import Attribute
from mjcompose.tree.pattern import EVERYTHING, paths_of
from mjcompose.tree.select import kind_of, name_of, section_of
from mjcompose.tree.unit import Unit
from mjcompose.tree.values import may_be_angle

if TYPE_CHECKING:
    from mjcompose.text.dump import Data

_BY_TYPE = ("sensor", "actuator", "equality", "tendon")
"""Sections of a recipe whose entries have a `type`. The entries of `contact` are below their tag."""


class Correction(Struct):
    """An entry of `drop` or `edit`, as `key` says."""

    key: str
    entry: dict[str, Data]

    @property
    def text(self) -> str:
        """The entry as a recipe writes it on one line."""
        return _on_one_line(self.key, [self.entry])


def without_attribute(node: Node, name: str) -> Correction | None:
    """Return the edit that removes an attribute which MJCF does not have; None if no selector selects its element."""
    settings: dict[str, Data] = {name: None}
    parent = node.getparent()
    while node.tag != "default" and parent is not None and section_of(node) == "default":
        settings = {str(node.tag): settings}
        node = parent
        parent = node.getparent()
    path = kind_of(node).path
    tag = next((each for each in (str(node.tag), path) if path in paths_of(each)), None)
    if tag is None:
        return None
    selected = name_of(node) or (MAIN if node.tag == "default" else EVERYTHING)
    return Correction("edit", {"select": {tag: selected}, "set": settings})


def keep_first(node: Node, name: str) -> Correction | None:
    """Return the entry of `drop` that removes an asset which repeats the name of another one."""
    if section_of(node) != "asset":
        return None  # dropping a body also drops its contents, and the elements that refer to them
    return Correction("drop", {str(node.tag): name, "where": "${index > 0}"})


def without_reference(node: Node, attribute: str, namespace: str, prefix: str = "") -> Correction | None:
    """Return the entry that removes a reference, and its element if that needs it.

    None if the element is part of another one. Names in the tree begin with `prefix`.
    """
    path = kind_of(node).path
    section = section_of(node)
    parent = node.getparent()
    is_whole = section == "worldbody" or (parent is not None and is_section(parent))
    if not is_whole or path not in paths_of(str(node.tag)):
        return None
    select: dict[str, Data] = {str(node.tag): (name_of(node) or "").removeprefix(prefix) or EVERYTHING}
    if EVERYTHING in select.values():
        select["where"] = {attribute: str(node.get(attribute)).removeprefix(prefix)}
    if can_do_without(node, namespace):
        return Correction("edit", {"select": select, "set": {attribute: None}})
    return Correction("drop", select)


def added_again(node: Node, attribute: str, namespace: str, target: str, unit: Unit) -> str | None:
    """Return the line of a recipe that writes a removed element, or reference, again, with the name of the `target`.

    Names in the tree are final. None if one line would not say all: of an element with children, a class or angles.
    """
    name = name_of(node)
    if can_do_without(node, namespace):
        change: dict[str, Data] = {"select": {str(node.tag): name}, "set": {attribute: target}}
        return Correction("edit", change).text if name else None
    attributes = kind_of(node).attributes
    written = [str(key) for key in node.keys() if key != "name"]  # noqa: SIM118 (an element is not a mapping)
    by_class = next(given(node, kind_of(node), unit.classes), None) is not None
    if len(node) or by_class or not all(_is_said_by_text(node, key) for key in written):
        return None
    section = section_of(node)
    values: dict[str, Data] = {key: _data(attributes[key], str(node.get(key))) for key in written}
    values[attribute] = target
    if section == "contact":
        entry: dict[str, Data] = {str(node.tag): [{**({"name": name} if name else {}), **values}]}
    elif section in _BY_TYPE and name:
        entry = {name: {"type": str(node.tag), **values}}
    else:
        return None
    return _on_one_line(section, entry)


def _on_one_line(key: str, value: Data) -> str:
    from mjcompose.text.dump import in_brackets  # imports yaml, and only an error needs it

    return f"{key}: {in_brackets(value)}"


def _is_said_by_text(node: Node, name: str) -> bool:
    """Return whether a recipe says the attribute with the same text: not a class, and not an angle without a unit."""
    attribute = kind_of(node).attributes.get(name)
    return attribute is not None and name != "class" and not may_be_angle(str(node.tag), attribute)


def _data(attribute: Attribute, text: str) -> Data:
    """Return the value of an attribute as a recipe writes it."""
    if attribute.type == "bool":
        return text == "true" if text in ("true", "false") else text
    if not attribute.is_number:
        return text
    numbers: list[Data] = [int(each) if each.lstrip("-").isdigit() else float(each) for each in text.split()]
    return numbers[0] if attribute.max_length == 1 and len(numbers) == 1 else numbers
