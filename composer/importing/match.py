"""Find parts in a merged model by the names and the structure of their bodies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

SEPARATORS = ("__", "/", ":", ".", "-", "_")
_ENOUGH = 0.5  # share of a part's bodies, matched by name


@dataclass(slots=True)
class Instance:
    """A part at its place in the merged model.

    `prefix` starts the part's names there. `key` and `out` are the prefix in the recipe, without and with its
    separator; they differ from `prefix` if a recipe cannot use that one.
    """

    part: int
    prefix: str
    root: Node
    """The part's own root body."""
    body: Node
    """The corresponding body of the merged model."""
    likeness: float
    key: str = ""
    out: str = ""
    is_base: bool = False
    names: frozenset[str] = field(default=frozenset())
    """The names of the part's bodies."""


def find(merged: Unit, parts: list[Unit]) -> list[Instance]:
    """Return the places of the parts, in the order of the merged model's bodies; they do not overlap."""
    bodies = {str(body.get("name")): body for body in _bodies(merged) if body.get("name")}
    candidates: list[Instance] = []
    for number, part in enumerate(parts):
        candidates += _of_part(number, part, bodies)
    found: list[Instance] = []
    taken: set[str] = set()
    for each in sorted(candidates, key=lambda each: (-each.likeness, -len(each.names), each.part)):
        here = {each.prefix + name for name in each.names} & bodies.keys()
        if not here & taken:
            taken |= here
            found.append(each)
    order = {name: index for index, name in enumerate(bodies)}
    return sorted(found, key=lambda each: order[str(each.body.get("name"))])


def separator_of(found: list[Instance]) -> str:
    """Return the separator that all prefixes end with; `/` if they have none in common."""
    prefixes = [each.prefix for each in found if each.prefix]
    for separator in SEPARATORS:
        if prefixes and all(each.endswith(separator) and each != separator for each in prefixes):
            return separator
    return "/"


def name_in_recipe(found: list[Instance], labels: list[str], separator: str) -> None:
    """Choose the base, and the key of every other part."""
    base = next((each for each in found if not each.prefix and _in_world(each.body)), None)
    if base is not None:
        base.is_base = True
    taken: set[str] = set()
    for each in found:
        if each.is_base:
            continue
        key = each.prefix.removesuffix(separator) if each.prefix.endswith(separator) else labels[each.part]
        if separator in ("/", ":"):
            key = key.replace(separator, "_")
        while key in taken or key == "base":
            key += "2"
        taken.add(key)
        each.key, each.out = key, key + separator


def parent_body(body: Node) -> Node | None:
    """Return the body around, ignoring frames; None for the world."""
    parent = body.getparent()
    while parent is not None and parent.tag not in ("body", "worldbody"):
        parent = parent.getparent()
    return parent if parent is not None and parent.tag == "body" else None


def _of_part(number: int, part: Unit, bodies: dict[str, Node]) -> Iterator[Instance]:
    own = frozenset(str(body.get("name")) for body in _bodies(part) if body.get("name"))
    root = next((body for body in _bodies(part) if body.get("name")), None)
    if root is None:
        return
    name = str(root.get("name"))
    for there, body in bodies.items():
        if there.endswith(name):
            prefix = there.removesuffix(name)
            likeness = sum(prefix + each in bodies for each in own) / len(own)
            if likeness >= _ENOUGH:
                yield Instance(number, prefix, root, body=body, likeness=likeness, names=own)


def _bodies(unit: Unit) -> Iterator[Node]:
    for world in unit.root.iterchildren("worldbody"):
        yield from world.iter("body")


def _in_world(body: Node) -> bool:
    return parent_body(body) is None
