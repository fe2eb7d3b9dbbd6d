"""The order of actuators that `<replicate>` multiplies, together with the tendons and joints that they refer to.

MuJoCo carries out the replicates one after another, inner ones first. Each replicate removes from their lists the
tendons and actuators that refer to something inside it, and appends a copy of each for its first copy, then for its
second, and so on. Elements that also refer to something outside the replicate are not copied and are lost.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import product
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.tree.names import DECLARES, REFERS, naming_table

Name = tuple[str, str]
"""Namespace and name."""


Within = tuple[tuple[Node, int], ...]
"""The number of a copy in each `<replicate>` that makes it, innermost first."""


class Copy(NamedTuple):
    """One of the joints, actuators or mocap bodies that MuJoCo makes of an element.

    `twists` stands for the joints in which a rod, a `<flexcomp>` of one dimension, is twisted: they are elsewhere
    than its vertices.
    """

    element: Node
    within: Within = ()
    twists: bool = False


def element_of(holder: Node | Copy) -> Node:
    """Return the element that is written in the tree."""
    return holder.element if isinstance(holder, Copy) else holder


@dataclass(frozen=True, slots=True)
class _Thing:
    """A tendon or an actuator after the replicates carried out so far."""

    element: Node
    within: Within
    name: str
    refers: frozenset[Name]

    def copied(self, replicate: Node, number: int, suffix: str, lost: frozenset[Name]) -> _Thing:
        """Return a copy that refers to the copies of what is `lost`."""
        refers = frozenset(
            (kind, name + suffix if (kind, name) in lost else name) for kind, name in self.refers
        )
        name = self.name + suffix if self.name else ""
        return replace(self, within=(*self.within, (replicate, number)), name=name, refers=refers)


def actuators_in_order(root: Node) -> list[Node | Copy]:
    """Return every actuator of a model in the order of its controls. A multiplied one is returned as its copies."""
    actuators = root.findall("actuator/*")
    if not actuators or next(root.iter("replicate"), None) is None:
        return list(actuators)
    replicates = [each for world in root.iterchildren("worldbody") for each in inner_first(world)]
    hanging = [_thing(each, "tendon") for each in root.iterfind("tendon/*")]
    driving = [_thing(each, "actuator") for each in actuators]
    made: dict[Node, list[Name]] = {}
    for replicate in replicates:
        inside = list(_declared(replicate, made))
        made[replicate] = [(kind, name + end) for end in suffixes(replicate) for kind, name in inside]
        lost = frozenset(inside)
        hanging, gone = _multiply(hanging, lost, replicate)
        driving, _ = _multiply(driving, lost | gone, replicate)
    return [Copy(each.element, each.within) if each.within else each.element for each in driving]


def names_made(root: Node) -> set[Name]:
    """Return every name in the body tree that a replicate makes."""
    made: dict[Node, list[Name]] = {}
    for world in root.iterchildren("worldbody"):
        for replicate in inner_first(world):
            inside = list(_declared(replicate, made))
            made[replicate] = [(kind, name + end) for end in suffixes(replicate) for kind, name in inside]
    return {name for names in made.values() for name in names}


def _multiply(
    things: list[_Thing], lost: frozenset[Name], replicate: Node
) -> tuple[list[_Thing], frozenset[Name]]:
    """Multiply the things that refer to `lost` names, as a replicate does. Return all things, and the old names."""
    # MuJoCo 4.0 multiplies what refers to something inside, too: `<motor joint="j"/>` on the joint of a body in
    # `<replicate count="2">` gives two controls. They stand behind the actuators that are not multiplied.
    # With `<motor name="z" …/>` behind `a` on a joint outside, the order is z, a0, a1.
    kept = [thing for thing in things if thing.refers.isdisjoint(lost)]
    taken = [thing for thing in things if not thing.refers.isdisjoint(lost)]
    whole = [thing for thing in taken if thing.refers <= lost]
    ends = suffixes(replicate)
    copies = [
        thing.copied(replicate, number, end, lost) for number, end in enumerate(ends) for thing in whole
    ]
    return kept + copies, frozenset(("tendon", thing.name) for thing in taken if thing.name)


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
        name, kind = child.get("name"), _kinds().get(str(child.tag))
        if name and kind:
            yield kind, name
        yield from _declared(child, made)


@cache
def _kinds() -> dict[str, str]:
    """Return, by tag of the body tree, the namespace in which it declares names."""
    return {
        tag: namespace
        for tag, actions in naming_table("worldbody").items()
        for name, (action, namespace) in actions.items()
        if action == DECLARES and name == "name"
    }


def ends_of_copies(around: Sequence[Node]) -> dict[str, Within]:
    """Return the copies that these replicates, innermost first, make of what is in them, by the ends of their names."""
    if not around:
        return {}
    copies = product(*(enumerate(suffixes(replicate)) for replicate in around))
    return {
        "".join(end for _, end in each): tuple(zip(around, (number for number, _ in each), strict=True))
        for each in copies
    }


def names_of_copies(element: Node) -> list[str]:
    """Return the names that MuJoCo gives to an element: its own, or those of its copies."""
    name = str(element.get("name") or "")
    ends = ends_of_copies(list(element.iterancestors("replicate")))
    return [name + end for end in ends or [""]] if name else []


def suffixes(replicate: Node) -> list[str]:
    """Return the suffixes of the names in each copy. All have as many digits as the count: ten begin at `00`."""
    count = int(str(replicate.get("count") or 1))
    # `<replicate count="12"><body name="r"/></replicate>` makes r00 to r11 in MuJoCo 4.0, and `count="9"` r0 to r8.
    width = len(str(count))
    return [f"{replicate.get('sep') or ''}{number:0{width}}" for number in range(count)]


def _thing(element: Node, section: str) -> _Thing:
    table = naming_table(section)
    refers = {
        (namespace, str(each.get(name)))
        for each in element.iter("*")
        for name, (action, namespace) in table.get(str(each.tag), {}).items()
        if action == REFERS and each.get(name) and namespace != "default"
    }
    return _Thing(element, (), str(element.get("name") or ""), frozenset(refers))
