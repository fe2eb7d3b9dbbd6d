"""The expansion of every `<replicate>` of a model: the copies of elements, with their names and their order.

MuJoCo carries out the replicates one after another, inner ones first. Each replicate copies its content, and appends a
number to every name in it. Elements outside the body tree that refer to a name inside are removed, and their copies
are appended: first all copies for the first copy of the replicate, then for its second, and so on.

This module computes the *meaning* of a model and never measures. MuJoCo (3.12 to 4.0) differs from the meaning in two
ways, and drops or multiplies elements without an error. `link/boundaries.py` and `link/replicates.py` prevent that
where they can, and `link/existence.py` reports the rest:

- An equality, an actuator or a tuple vanishes if one of its names is inside of a replicate and another one is not.
- An element without references, such as a clock, is multiplied by every replicate. So is an element that refers to `j1`
  if there is a `j10` when MuJoCo reads the replicate.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from itertools import product
from math import prod
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.limits import in_force
from mjcompose.link import numbers
from mjcompose.tree.names import WORLD, declaration, own_references

Name = tuple[str, str]
"""Namespace and name."""

Within = tuple[tuple[Node, int], ...]
"""The number of a copy in each `<replicate>` that makes it, innermost first."""


class Copy(NamedTuple):
    """A joint, actuator or mocap body that MuJoCo makes from an element; `twists` marks joints that twist a rod."""

    element: Node
    within: Within = ()
    twists: bool = False


def element_of(holder: Node | Copy) -> Node:
    return holder.element if isinstance(holder, Copy) else holder


SECTIONS = ("tendon", "contact", "deformable", "equality", "actuator", "sensor", "custom")
"""The sections outside the body tree whose elements a replicate copies; each refers only to those before it."""

COPIED = frozenset("body joint geom site camera light tendon equality actuator sensor pair exclude flex skin".split())
"""The namespaces whose names get the number of the copy; assets, numbers and texts keep their names."""

_ALL_OR_NOTHING = frozenset({"equality", "actuator", "custom"})
"""Sections whose elements MuJoCo drops if a replicate contains some of their references and not the others."""


class OutsideElement(Struct):
    """An element outside the body tree, after the replicates carried out so far.

    `within` lists the copies of replicates that it belongs to, in the order in which they were carried out, and
    `references` maps each name in the element to the name in this copy.
    """

    element: Node
    section: str
    within: Within
    name: str
    references: Mapping[Name, Name]

    @classmethod
    def of(cls, element: Node, section: str) -> OutsideElement:
        references = {name: name for name in references_to_copied(element, section)}
        return cls(element, section, (), str(element.get("name") or ""), references=references)

    @property
    def holder(self) -> Node | Copy:
        return Copy(self.element, self.within) if self.within else self.element

    def copied(self, replicate: Node, number: int, suffix: str, inside: Collection[Name]) -> OutsideElement:
        references = {
            old: ((new[0], new[1] + suffix) if new in inside else new) for old, new in self.references.items()
        }
        name = self.name + suffix if self.name else ""
        return replace(self, within=(*self.within, (replicate, number)), name=name, references=references)


def references_to_copied(element: Node, section: str) -> list[Name]:
    """Return the references of an element, and of those in it, to kinds of elements that a replicate copies."""
    return [
        (namespace, name)
        for node in element.iter("*")
        for _, namespace, name, _ in own_references(node, section)
        if namespace in COPIED
    ]


class Crossing(NamedTuple):
    """An element that MuJoCo drops: it refers to something `inside` of a replicate, and to something `outside`."""

    row: OutsideElement
    replicate: Node
    inside: Name
    outside: Name


class _Section:
    """The rows of one section in MuJoCo's order, found by the names that they refer to."""

    def __init__(self, root: Node, tag: str) -> None:
        self.tag = tag
        self.rows: dict[int, OutsideElement] = {}
        self._users: dict[Name, list[int]] = {}
        self._count = 0
        for node in root.iterfind(f"{tag}/*"):
            self._append(OutsideElement.of(node, tag))

    def _append(self, row: OutsideElement) -> None:
        self.rows[self._count] = row
        for name in row.references.values():
            self._users.setdefault(name, []).append(self._count)
        self._count += 1

    def affected(self, inside: Collection[Name]) -> list[int]:
        """Return the numbers of the rows that refer to one of these names."""
        numbers = {number for name in inside for number in self._users.get(name, ())}
        return sorted(number for number in numbers if number in self.rows)

    def multiply(self, numbers: Sequence[int], inside: Collection[Name], replicate: Node) -> set[Name]:
        """Replace these rows by their copies, and return the names that no longer exist."""
        # MuJoCo 4.0 puts the copies after the rows that stay: with `<motor name="a" joint="j"/>` on a joint in
        # `<replicate count="2">` and `<motor name="z" …/>` behind it on a joint outside, the order is z, a0, a1.
        removed = [self.rows.pop(number) for number in numbers]
        ends = suffixes(replicate) if removed and _is_allowed(len(removed) * copies_of(replicate)) else []
        for number, suffix in enumerate(ends):
            for row in removed:
                self._append(row.copied(replicate, number, suffix, inside=inside))
        return {(_namespace(row), row.name) for row in removed if row.name}


class Expansion(Struct):
    """The elements outside the body tree after all replicates, by section, and those that MuJoCo drops."""

    rows: Mapping[str, Sequence[OutsideElement]]
    crossings: Sequence[Crossing] = field(default_factory=list)

    @classmethod
    def of(cls, root: Node, tags: Collection[str] = SECTIONS) -> Expansion:
        """Return the expansion of a model in these sections, and in those that they refer to."""
        sections = [_Section(root, tag) for tag in SECTIONS if tag in tags or tag in ("tendon", "actuator")]
        crossings: list[Crossing] = []
        made: dict[Node, list[Name]] = {}
        for replicate, declared in names_inside(root, made):
            inside = set(declared)
            for section in sections:
                numbers = section.affected(inside)
                crossings += _crossings(section, numbers, inside, replicate=replicate)
                inside |= section.multiply(numbers, inside, replicate)
        return cls({section.tag: list(section.rows.values()) for section in sections}, crossings)


def _namespace(row: OutsideElement) -> str:
    declared = declaration(row.element, row.section)
    return row.section if declared is None else declared[0]


def _crossings(
    section: _Section, numbers: Iterable[int], inside: Collection[Name], replicate: Node
) -> Iterator[Crossing]:
    """Yield the rows, all of which refer to names `inside`, that MuJoCo drops."""
    if section.tag not in _ALL_OR_NOTHING:
        return
    for row in map(section.rows.__getitem__, numbers):
        names = list(row.references.values())
        # A tuple may refer to the world. MuJoCo 3.12 drops an equality that names it, 4.0 keeps it.
        others = (name for name in names if name not in inside and (section.tag == "equality" or name[1] != WORLD))
        outside = next(others, None)
        if outside is not None:
            yield Crossing(row, replicate, next(name for name in names if name in inside), outside)


def actuators_in_order(root: Node) -> list[Node | Copy]:
    """Return every actuator of a model in the order of its controls. For a multiplied actuator, return its copies."""
    return in_order(root, "actuator")


def in_order(root: Node, section: str) -> list[Node | Copy]:
    """Return the elements of the section `actuator` or `sensor` in MuJoCo's order, with all copies."""
    elements = root.findall(f"{section}/*")
    if not elements or next(root.iter("replicate"), None) is None:
        return list(elements)
    return [row.holder for row in Expansion.of(root, (section,)).rows[section]]


def copied_names(root: Node) -> set[Name]:
    made: dict[Node, list[Name]] = {}
    for _ in names_inside(root, made):
        pass
    return {name for names in made.values() for name in names}


def names_inside(root: Node, made: dict[Node, list[Name]]) -> Iterator[tuple[Node, list[Name]]]:
    """Yield each replicate, inner ones first, with the names in it, and note the names that it makes in `made`."""
    for world in root.iterchildren("worldbody"):
        for replicate in inner_first(world):
            inside = list(_declared(replicate, made))
            ends = suffixes(replicate) if _is_allowed(max(len(inside), 1) * copies_of(replicate)) else []
            made[replicate] = [(kind, name + end) for end in ends for kind, name in inside]
            yield replicate, inside


def _is_allowed(copies: int) -> bool:
    """Return whether a model with this number of copies is built at all; `check_size` reports that it makes more."""
    return copies <= in_force().expansion


def inner_first(top: Node) -> Iterator[Node]:
    """Return every replicate in `top`, including `top` itself, in the order in which MuJoCo applies them."""
    # MuJoCo 4.0 appends the number of the inner replicate first: a `<body name="b"/>` in `<replicate count="2"
    # sep="-">` in `<replicate count="2" sep="_">` becomes b-0_0, b-1_0, b-0_1, b-1_1.
    for child in top.iterchildren("*"):
        yield from inner_first(child)
    if top.tag == "replicate":
        yield top


def _declared(replicate: Node, made: dict[Node, list[Name]]) -> Iterator[Name]:
    """Yield the names inside a replicate, including those that inner replicates have made."""
    for child in replicate.iterchildren("*"):
        if child.tag == "replicate":
            yield from made[child]
            continue
        declared = declaration(child, "worldbody")
        if declared is not None:
            yield declared
        yield from _declared(child, made)


def ends_of_copies(around: Sequence[Node]) -> dict[str, Within]:
    """Return the copies that these replicates, innermost first, make from their content, by the ends of their names."""
    if not around or not _is_allowed(prod(map(copies_of, around))):
        return {}
    copies = product(*(enumerate(suffixes(replicate)) for replicate in around))
    return {
        "".join(end for _, end in each): tuple(zip(around, (number for number, _ in each), strict=True))
        for each in copies
    }


def names_of_copies(element: Node) -> list[str]:
    name = str(element.get("name") or "")
    ends = ends_of_copies(list(element.iterancestors("replicate")))
    return [name + end for end in ends or [""]] if name else []


def name_of_holder(holder: Node | Copy) -> str:
    """Return the name that MuJoCo gives to an element or to its copy; empty if it has none."""
    name = str(element_of(holder).get("name") or "")
    within = holder.within if name and isinstance(holder, Copy) else ()
    return name + "".join(suffixes(replicate)[number] for replicate, number in within)


def suffixes(replicate: Node) -> list[str]:
    """Return the suffixes of the names in each copy, none for more copies than are allowed.

    All have as many digits as the count: ten begin at `00`.
    """
    count = copies_of(replicate)
    # `<replicate count="12"><body name="r"/></replicate>` makes r00 to r11 in MuJoCo 4.0, and `count="9"` r0 to r8.
    width = len(str(count))
    listed = count if _is_allowed(count) else 0
    return [f"{replicate.get('sep') or ''}{number:0{width}}" for number in range(listed)]


def copies_of(replicate: Node) -> int:
    return numbers.integer(str(replicate.get("count") or 1))
