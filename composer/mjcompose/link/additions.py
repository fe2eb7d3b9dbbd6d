"""Elements that the recipe adds and that parts are attached to: they come into the model before these parts."""

from __future__ import annotations

from lxml.etree import _Element as Node

from mjcompose.link.linking import AddedElement, Linking, PlaceName
from mjcompose.tree import journal
from mjcompose.tree.classes import NESTED
from mjcompose.tree.journal import because, explained

_TAKING_CLASS = ("geom", "site", "camera", "light")


def holder_of(linking: Linking, addition: AddedElement) -> Node | None:
    """Return the element to which an addition goes, or None if it does not exist yet."""
    kind, name = addition.to
    return linking.base.section("worldbody") if kind == "world" else linking.names.find(kind, name)


BRINGS = because("contains elements of the parts")


def world_of(linking: Linking) -> Node:
    """Return the world of the model; the base may have none yet."""
    with explained(BRINGS):
        return linking.base.section("worldbody")


def waiting(linking: Linking, place: PlaceName) -> list[AddedElement]:
    """Return the additions that a place needs and that are not in the model yet, the outermost first."""
    needed = {place}
    chain: list[AddedElement] = []
    for addition in reversed(linking.additions):  # each comes after the elements that it is added to
        if not addition.is_hung and not needed.isdisjoint(addition.places):
            chain.append(addition)
            needed.add(addition.to)
    return chain[::-1]


def declare(linking: Linking, node: Node) -> None:
    """Make the places in a new element known: later entries may add to them, and parts may be attached to them."""
    for place in node.iter("body", "frame", "site"):
        name = place.get("name")
        if name:
            linking.names.declared.setdefault(str(place.tag), {}).setdefault(str(name), place)


def hang(linking: Linking, addition: AddedElement, holder: Node) -> None:
    """Append an addition; in the world it takes the base's top class, as if it were written in the base."""
    node = addition.node
    if addition.to[0] == "world" and linking.base_class is not None:
        # Each child has its own class: for `<worldbody childclass="c">` MuJoCo 4.0 says "World body cannot have
        # attributes".
        if node.tag in NESTED:
            if node.get("childclass") is None:
                journal.write(node, "childclass", linking.base_class)
        elif node.tag in _TAKING_CLASS and node.get("class") is None:
            journal.write(node, "class", linking.base_class)
    journal.place(holder, node)
    declare(linking, node)


def later_names(linking: Linking) -> list[PlaceName]:
    """Return the places that the recipe adds and that do not exist yet."""
    there = {place for addition in linking.additions if addition.is_hung for place in addition.places}
    return [place for place in linking.later_places if place not in there]


def outermost_target(linking: Linking, place: PlaceName) -> PlaceName | None:
    """Return the element to which a place and everything around it is added, or None if the recipe does not add it."""
    target: PlaceName | None = None
    seen: set[PlaceName] = set()
    while place in linking.later_places and place not in seen:
        seen.add(place)
        target = place = linking.later_places[place].to
    return target
