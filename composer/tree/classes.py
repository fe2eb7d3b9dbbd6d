"""Default classes: which class is in effect, and which values it sets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from functools import cache, cached_property

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR

MAIN = "main"
ORIENTATIONS = ("quat", "axisangle", "xyaxes", "zaxis", "euler")
NESTED = ("body", "frame", "replicate")


@dataclass(slots=True)
class DefaultClass:
    """One class: its own settings by element tag; everything else comes from `parent`.

    There is one top class for each top-level `<default>`: a class inherits only what was written before it.
    """

    name: str
    parent: DefaultClass | None
    elements: dict[str, list[Node]] = field(default_factory=dict)

    def lookup(self, tag: str, attribute: str) -> tuple[str, Node] | None:
        """Return the value that reaches an element of `tag` through this class, and the element that writes it."""
        here: DefaultClass | None = self
        while here is not None:
            for element in reversed(here.elements.get(tag, ())):
                value = written(element, attribute)
                if value is not None:
                    return value, element
            here = here.parent
        return None

    def orientation(self, tag: str) -> tuple[str, str] | None:
        """Return name and value of the nearest orientation that this class sets."""
        here: DefaultClass | None = self
        while here is not None:
            for element in reversed(here.elements.get(tag, ())):
                for name in ORIENTATIONS:
                    value = element.get(name)
                    if value:
                        return name, str(value)
            here = here.parent
        return None

    def sets(self, tag: str) -> bool:
        here: DefaultClass | None = self
        while here is not None:
            if any(map(says_something, here.elements.get(tag, ()))):
                return True
            here = here.parent
        return False


def written(element: Node, attribute: str) -> str | None:
    """Return the value that an element or a class writes; as in MuJoCo, a blank in place of numbers does not count.

    >>> from lxml import etree
    >>> geom = etree.fromstring('<geom mass="" material=""/>')
    >>> written(geom, "mass"), written(geom, "material")
    (None, '')
    """
    value = element.get(attribute)
    if value is None or (not value.strip() and attribute in _numeric()):
        return None
    return str(value)


@cache
def _numeric() -> frozenset[str]:
    """Return the attributes of classes that hold numbers."""
    kinds = [
        GRAMMAR.element(f"default/{tag}") for tag in GRAMMAR.element("default").children if tag != "default"
    ]
    return frozenset(each.name for kind in kinds for each in kind.attributes.values() if each.is_number)


def says_something(element: Node) -> bool:
    """Return whether a default element sets anything; the tag of an actuator alone sets its type."""
    return bool(len(element.attrib) or len(element)) or element.tag in _actuators()


@cache
def _actuators() -> frozenset[str]:
    return frozenset(GRAMMAR.section("actuator").children)


class Classes:
    """The class tree of one model, read on first use."""

    def __init__(self, root: Node) -> None:
        self._root = root

    @cached_property
    def by_name(self) -> dict[str, DefaultClass]:
        found = {MAIN: DefaultClass(MAIN, None)}
        for at, section in enumerate(self._root.iterchildren("default")):
            if at:  # a later section's top class does not affect the classes of an earlier one
                found[MAIN] = DefaultClass(MAIN, found[MAIN])
            _read(section, found[MAIN], found)
        return found

    def give(self, tag: str, *attributes: str) -> bool:
        """Return whether any class sets one of these attributes for elements of `tag`."""
        return any(
            written(element, attribute) is not None
            for section in self._root.iterchildren("default")
            for element in section.iter(tag)
            for attribute in attributes
        )

    def get(self, name: str | None) -> DefaultClass:
        """Return the class of that name; the top class for None and for unknown names."""
        return self.by_name.get(name or MAIN) or self.by_name[MAIN]

    def effective(self, element: Node, childclass: str | None, attribute: str) -> str | None:
        """Return the effective value of `attribute`: the element's own first.

        `childclass` is the one in force around the element.
        """
        value = written(element, attribute)
        if value is not None:
            return value
        found = self.get(str(element.get("class") or childclass or MAIN)).lookup(
            default_tag(element), attribute
        )
        return found[0] if found else None


def _read(section: Node, into: DefaultClass, found: dict[str, DefaultClass]) -> None:
    for child in section:
        tag = child.tag
        if tag == "default":
            nested = DefaultClass(str(child.get("class", "")), into)
            found[nested.name] = nested
            _read(child, nested, found)
        elif isinstance(tag, str):
            into.elements.setdefault(tag, []).append(child)


def default_tag(element: Node) -> str:
    """Return the tag under which a default class holds settings for `element`."""
    parent = element.getparent()
    if parent is not None:
        if parent.tag == "equality":
            return "equality"
        if parent.tag == "tendon":
            return "tendon"
    return str(element.tag)


def childclass_of(element: Node) -> str | None:
    """Return the childclass in force for `element`: that of the nearest ancestor that has one."""
    parent = element.getparent()
    while parent is not None:
        value = parent.get("childclass")
        if value:
            return str(value)
        parent = parent.getparent()
    return None


def walk_bodies(root: Node) -> Iterator[tuple[Node, str | None]]:
    """Yield every element of the body tree in document order, with the childclass in force around it."""
    for worldbody in root.iterchildren("worldbody"):
        yield from _walk(worldbody, None)


def _walk(parent: Node, childclass: str | None) -> Iterator[tuple[Node, str | None]]:
    stack: list[tuple[Iterator[Node], str | None]] = [(parent.iterchildren("*"), childclass)]
    while stack:
        children, active = stack[-1]
        for child in children:
            yield child, active
            if child.tag in NESTED:
                stack.append((child.iterchildren("*"), str(child.get("childclass") or "") or active))
                break
        else:
            stack.pop()


def through_frames(parent: Node) -> Iterator[Node]:
    """Yield the children of a body, including those in its frames, which do not count as bodies."""
    for child in parent:
        tag = child.tag
        if tag == "frame":
            yield from through_frames(child)
        elif isinstance(tag, str):
            yield child


def own(body: Node, *tags: str) -> list[Node]:
    """Return the elements with those tags that belong to the body itself, including those in frames and replicates."""
    found: list[Node] = []
    for child in body:
        if child.tag in tags:
            found.append(child)
        elif child.tag in ("frame", "replicate"):
            found.extend(own(child, *tags))
    return found
