"""The elements of a model by kind and name, with their effective values."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.grammar.element import ElementType
from composer.grammar.format import to_text
from composer.importing.meaning import is_rounded
from composer.tree.classes import childclass_of
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

SECTIONS = ("worldbody", "tendon", "equality", "actuator", "sensor", "contact")
_SETTINGS = ("option", "size", "visual", "statistic")
_CLASSES = frozenset({"name", "class", "childclass"})


@dataclass(frozen=True, slots=True)
class Item:
    """An element with or without a name; `namespace` is where its name must be unique."""

    node: Node
    kind: ElementType
    section: str
    namespace: str

    @property
    def name(self) -> str:
        return str(self.node.get("name") or "")


def items(unit: Unit) -> Iterator[Item]:
    """Yield the elements of the body tree and of the sections in their order, without the steps of tendons."""
    for section in unit.root:
        if section.tag not in SECTIONS:
            continue
        kinds = GRAMMAR.within(str(section.tag))
        nodes = section.iter("*") if section.tag == "worldbody" else section.iterchildren("*")
        for node in nodes:
            kind = kinds.get(str(node.tag))
            name = None if kind is None else kind.attributes.get("name")
            if node is not section and kind is not None and name is not None and name.declares is not None:
                yield Item(node, kind, str(section.tag), namespace=name.declares)


def named(unit: Unit) -> dict[tuple[str, str], Item]:
    """Return the elements that have a name."""
    return {(each.namespace, each.name): each for each in items(unit) if each.name}


def effective(item: Item, unit: Unit) -> dict[str, str]:
    """Return the values that an element writes or gets from its class, without names and classes."""
    around = childclass_of(item.node)
    found = {}
    for name in item.kind.attributes:
        if name not in _CLASSES:
            value = unit.classes.effective(item.node, around, name)
            if value is not None:
                found[name] = " ".join(value.split())
    return found


def differing(
    one: dict[str, str], other: dict[str, str], kind: ElementType, prefix: str
) -> dict[str, str | None]:
    """Return the values of `other` that `one` lacks; None for those that only `one` has.

    A name in `one` equals the same name with `prefix` before it in `other`.
    """
    changes: dict[str, str | None] = {}
    for name, attribute in kind.attributes.items():
        before, after = (each.get(name) or default_text(attribute) for each in (one, other))
        if before == after or (before and after and _same(before, after, attribute, prefix=prefix)):
            continue
        changes[name] = after
    return changes


def default_text(attribute: Attribute) -> str | None:
    """Return MuJoCo's default, if the grammar knows it."""
    return None if attribute.default in (None, ()) else to_text(attribute, attribute.default)


def _same(before: str, after: str, attribute: Attribute, prefix: str) -> bool:
    if attribute.is_number:
        try:
            a, b = ([float(each) for each in text.split()] for text in (before, after))
        except ValueError:
            return False
        default = [float(each) for each in (default_text(attribute) or "").split()]
        length = max(len(a), len(b))
        ours, theirs = ([*each, *default[len(each) : length]] for each in (a, b))
        return len(ours) == len(theirs) and all(map(is_rounded, ours, theirs))
    if attribute.is_reference:
        return [prefix + each for each in before.split()] == after.split()
    return attribute.type in ("file", "name")


def assets_of(unit: Unit) -> dict[tuple[str, str], Node]:
    """Return the assets by tag and name; an unnamed asset has the stem of its file as name."""
    return {
        (str(node.tag), str(node.get("name") or PurePosixPath(str(node.get("file") or "")).stem)): node
        for section in unit.root.iterchildren("asset")
        for node in section.iterchildren("*")
    }


def settings_of(unit: Unit) -> dict[tuple[str, ...], str]:
    found: dict[tuple[str, ...], str] = {}

    def walk(node: Node, path: tuple[str, ...]) -> None:
        found.update(
            {(*path, str(name)): " ".join(str(value).split()) for name, value in node.attrib.items()}
        )
        for child in node.iterchildren("*"):
            walk(child, (*path, str(child.tag)))

    for section in unit.root:
        if section.tag in _SETTINGS:
            walk(section, (str(section.tag),))
    return found
