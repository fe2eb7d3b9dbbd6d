"""Default classes, and the value of an attribute that is in effect."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from functools import cache, cached_property
from itertools import pairwise
from typing import Literal

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType, to_text

MAIN = "main"
ORIENTATIONS = ("quat", "axisangle", "xyaxes", "zaxis", "euler")
NESTED = ("body", "frame", "replicate")


class DefaultClass(Struct, frozen=False):
    """One class: its own settings by element tag; everything else comes from `parent`.

    There is one top class for each top-level `<default>`: a class inherits only attributes that are written before it.
    """

    name: str
    parent: DefaultClass | None
    elements: dict[str, list[Node]] = field(default_factory=dict)

    def line(self) -> Iterator[DefaultClass]:
        """Yield the class and all classes that it inherits from, the nearest first."""
        here: DefaultClass | None = self
        while here is not None:
            yield here
            here = here.parent

    def _writers(self, tag: str) -> Iterator[Node]:
        return (element for here in self.line() for element in reversed(here.elements.get(tag, ())))

    def lookup(self, tag: str, attribute: str) -> tuple[str, Node] | None:
        """Return the value that reaches an element of `tag` through this class, and the element that writes it."""
        pairs = ((written(element, attribute), element) for element in self._writers(tag))
        return next(((value, element) for value, element in pairs if value is not None), None)

    def orientation(self, tag: str) -> tuple[str, str] | None:
        """Return name and value of the nearest orientation that this class sets."""
        pairs = ((name, element.get(name)) for element in self._writers(tag) for name in ORIENTATIONS)
        return next(((name, str(value)) for name, value in pairs if value), None)

    def sets(self, tag: str) -> bool:
        return any(map(says_something, self._writers(tag)))


def written(element: Node, attribute: str) -> str | None:
    """Return the value that an element or a class writes; as in MuJoCo, a blank instead of numbers does not count.

    >>> from lxml import etree
    >>> geom = etree.fromstring('<geom mass="" material=""/>')
    >>> written(geom, "mass"), written(geom, "material")
    (None, '')
    """
    value = element.get(attribute)
    return None if value is None or (not value.strip() and attribute in _numeric()) else str(value)


@cache
def _numeric() -> frozenset[str]:
    kinds = [GRAMMAR.element(f"default/{tag}") for tag in GRAMMAR.element("default").children if tag != "default"]
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
        """Return the effective value of `attribute`, the element's own first; `childclass` is in force around it."""
        value = written(element, attribute)
        if value is not None:
            return value
        setting = self.get(element.get("class") or childclass).lookup(default_tag(element), attribute)
        return setting[0] if setting else None


def _read(section: Node, into: DefaultClass, found: dict[str, DefaultClass]) -> None:
    for child in section.iterchildren("*"):
        if child.tag == "default":
            nested = DefaultClass(str(child.get("class", "")), into)
            found[nested.name] = nested
            _read(child, nested, found)
        else:
            into.elements.setdefault(str(child.tag), []).append(child)


def default_tag(element: Node) -> str:
    """Return the tag under which a default class holds settings for `element`."""
    parent = element.getparent()
    return str(parent.tag if parent is not None and parent.tag in ("equality", "tendon") else element.tag)


def childclass_of(element: Node) -> str | None:
    """Return the childclass in force for `element`, from the nearest ancestor that has one."""
    around = (above.get("childclass") for above in element.iterancestors())
    return next((str(value) for value in around if value), None)


def walk_bodies(root: Node) -> Iterator[tuple[Node, str | None]]:
    """Yield every element of the body tree in document order, with the childclass in force around it."""
    stack: list[tuple[Iterator[Node], str | None]] = [
        (worldbody.iterchildren("*"), None) for worldbody in root.iterchildren("worldbody", reversed=True)
    ]
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
    for child in parent.iterchildren("*"):
        if child.tag == "frame":
            yield from through_frames(child)
        else:
            yield child


def own(body: Node, *tags: str) -> list[Node]:
    """Return the elements with those tags that belong to the body itself, including those in frames and replicates."""
    found: list[Node] = []
    for child in body:
        inside = own(child, *tags) if child.tag in ("frame", "replicate") else []
        found += [child] if child.tag in tags else inside
    return found


class Level(Struct):
    """One place that may set an attribute, the nearest first.

    `writer` is the element that writes it there, and `text` is the written text, or None if that level does not set it.
    `taken` is the range of its numbers in effect: a shorter list leaves the remaining numbers to the next levels.
    """

    kind: Literal["element", "class", "mujoco"]
    name: str | None
    writer: Node | None = None
    text: str | None = None
    taken: range = range(0)


class InForce(Struct):
    """The class in force for an element, and the element that selects it by `class` or `childclass`."""

    name: str
    attribute: Literal["class", "childclass"] | None = None
    writer: Node | None = None


def class_in_force(element: Node) -> InForce:
    """Return its own class, else the childclass around it, else the top class."""
    own = element.get("class")
    if own:
        return InForce(str(own), "class", element)
    around = childclass_of(element)
    if around is None:
        return InForce(MAIN)
    holder = next(ancestor for ancestor in element.iterancestors() if ancestor.get("childclass") == around)
    return InForce(around, "childclass", holder)


def chain(element: Node, classes: Classes) -> list[DefaultClass]:
    """Return the classes that apply to an element, the nearest first."""
    return list(classes.get(class_in_force(element).name).line())


def levels(element: Node, kind: ElementType, attribute: Attribute, classes: Classes) -> list[Level]:
    """Return every level that an attribute may come from, the element first and MuJoCo's default last."""
    found = [Level("element", None, element, text=written(element, attribute.name))]
    if kind.takes_class and attribute.in_default:
        for step in chain(element, classes):
            holders = reversed(_holders(step, element, attribute))  # the last one of several sets it
            writer = next((each for each in holders if written(each, attribute.name) is not None), None)
            found.append(Level("class", step.name, writer, text=None if writer is None else writer.get(attribute.name)))
    found.append(Level("mujoco", None, None, text=default_text(attribute)))
    return list(_taken(found, attribute))


def value(steps: list[Level]) -> str | None:
    """Return the effective value, completed from further levels if a class sets only its first numbers."""
    words = [word for each in steps if each.taken for word in (each.text or "").split()[each.taken.start :]]
    return " ".join(words) if words else next((step.text for step in steps if step.taken), None)


def text_in_effect(element: Node, kind: ElementType, name: str, classes: Classes) -> str | None:
    """Return the effective text of an attribute, or None if the element has no such attribute or nothing sets it."""
    attribute = kind.attributes.get(name)
    if attribute is None:
        return None
    words = (written(element, name) or "").split()
    if words and not _may_go_on(attribute, len(words)):
        return " ".join(words)
    return value(levels(element, kind, attribute, classes=classes))


def given(element: Node, kind: ElementType, classes: Classes) -> Iterator[tuple[Attribute, Level]]:
    """Yield every attribute that some class sets for an element, with the nearest level that sets it."""
    seen = {name for name in map(str, element.keys()) if written(element, name) is not None}
    turned = not seen.isdisjoint(ORIENTATIONS) or element.get("quat") is not None
    if kind.takes_class:
        for step in chain(element, classes):
            orientation = False
            for writer in reversed(_holders(step, element)):
                is_shared = writer.tag != element.tag and kind.family == "actuator"
                for name in map(str, writer.keys()):
                    attribute = kind.attributes.get(name)
                    if attribute is None or name in seen or written(writer, name) is None:
                        continue
                    if (is_shared and name not in _common()) or (turned and name in ORIENTATIONS):
                        continue
                    orientation |= name in ORIENTATIONS
                    seen.add(name)
                    yield attribute, Level("class", step.name, writer, text=str(writer.get(name)))
            turned |= orientation


@cache
def default_text(attribute: Attribute) -> str | None:
    """Return MuJoCo's default as text, if the grammar knows it."""
    default = attribute.default
    return None if default is None or default == () else to_text(attribute, default)


def _may_go_on(attribute: Attribute, count: int) -> bool:
    """Return whether further levels may give more numbers than the `count` that one level has."""
    longest = attribute.max_length if attribute.is_number else None
    return longest is not None and count < longest and attribute.min_length != longest


def _taken(steps: list[Level], attribute: Attribute) -> Iterator[Level]:
    joins = _may_go_on(attribute, 1)
    at = 0
    for step in steps:
        if step.text is not None and (at == 0 or joins):
            end = max(at, len(step.text.split()), 1)
            yield Level(step.kind, step.name, step.writer, text=step.text, taken=range(at, end))
            at = end
        else:
            yield step


def _holders(step: DefaultClass, element: Node, attribute: Attribute | None = None) -> list[Node]:
    """Return the elements of a class that apply to this one; actuators share their defaults for common attributes."""
    parent = element.getparent()
    tag = default_tag(element)
    if parent is None or parent.tag != "actuator":
        return step.elements.get(tag, [])
    # MuJoCo 4.0 has one default for all actuators of a class: `<motor ctrlrange="…"/>` also reaches each `<general>`.
    common = attribute is None or attribute.name in _common()
    tags = [path.rpartition("/")[2] for path in GRAMMAR.families["actuator"]] if common else [tag]
    return sorted((each for name in tags for each in step.elements.get(name, ())), key=position)


def position(node: Node) -> list[int]:
    """Return the position of a node in its document as a sort key."""
    return [above.index(below) for above, below in pairwise([node, *node.iterancestors()][::-1])]


@cache
def _common() -> frozenset[str]:
    """Return the attributes that any actuator of a class sets for all: the attributes of a motor."""
    return frozenset(GRAMMAR.element("actuator/motor").attributes)
