"""The effective value of an attribute: written on the element, set by a class, or MuJoCo's default."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, Literal

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR, ElementType
from composer.grammar.attribute import Attribute
from composer.grammar.format import to_text
from composer.tree.classes import (
    MAIN,
    ORIENTATIONS,
    Classes,
    DefaultClass,
    childclass_of,
    default_tag,
    written,
)

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


@dataclass(frozen=True, slots=True)
class Level:
    """One place that may set an attribute, the nearest first.

    `writer` is the element that writes it there, `text` the written text; None if that level does not set it.
    `taken` is the range of its numbers in effect: a shorter list leaves the remaining ones to the next levels.
    """

    kind: Literal["element", "class", "mujoco"]
    name: str | None
    writer: Node | None = None
    text: str | None = None
    taken: range = range(0)


@dataclass(frozen=True, slots=True)
class InForce:
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
    holder = next(each for each in element.iterancestors() if each.get("childclass") == around)
    return InForce(around, "childclass", holder)


def chain(element: Node, classes: Classes) -> list[DefaultClass]:
    """Return the classes that apply to an element, the nearest first."""
    found: DefaultClass | None = classes.get(class_in_force(element).name)
    steps = []
    while found is not None:
        steps.append(found)
        found = found.parent
    return steps


def levels(element: Node, kind: ElementType, attribute: Attribute, classes: Classes) -> list[Level]:
    """Return every level that an attribute may come from, the element first and MuJoCo's default last."""
    found = [Level("element", None, element, text=written(element, attribute.name))]
    if kind.takes_class and attribute.in_default:
        for step in chain(element, classes):
            writer = _writer(step, element, attribute)
            found.append(
                Level("class", step.name, writer, text=None if writer is None else writer.get(attribute.name))
            )
    found.append(Level("mujoco", None, None, text=default_text(attribute)))
    return list(_taken(found, attribute))


def value(steps: list[Level]) -> str | None:
    """Return the effective value, completed from further levels if a class sets only its first numbers."""
    words = [word for step in steps if step.text is not None for word in _words(step)]
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
    """Yield every attribute that some class sets for an element, with the nearest level that does."""
    seen = {name for name in map(str, element.keys()) if written(element, name) is not None}
    turned = not seen.isdisjoint(ORIENTATIONS) or element.get("quat") is not None
    for step in chain(element, classes) if kind.takes_class else ():
        orientation = False
        for writer in reversed(_holders(step, element)):
            for name in map(str, writer.keys()):
                attribute = kind.attributes.get(name)
                if attribute is None or name in seen or written(writer, name) is None:
                    continue
                if writer.tag != element.tag and kind.family == "actuator" and name not in _common():
                    continue
                if name in ORIENTATIONS:
                    if turned:
                        continue
                    orientation = True
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
        if step.text is None or (at > 0 and not joins):
            yield step
            continue
        count = max(len(step.text.split()), 1)
        yield Level(step.kind, step.name, step.writer, text=step.text, taken=range(at, max(at, count)))
        at = max(at, count)


def _words(step: Level) -> list[str]:
    assert step.text is not None
    words = step.text.split()
    return words[step.taken.start : step.taken.stop] if step.taken else []


def _writer(step: DefaultClass, element: Node, attribute: Attribute) -> Node | None:
    """Return the element of a class that sets the attribute; if there are several, the last one."""
    for holder in reversed(_holders(step, element, attribute)):
        if written(holder, attribute.name) is not None:
            return holder
    return None


def _holders(step: DefaultClass, element: Node, attribute: Attribute | None = None) -> list[Node]:
    """Return the elements of a class that apply to this one.

    All actuators share their defaults for common attributes.
    """
    parent = element.getparent()
    tag = default_tag(element)
    if parent is None or parent.tag != "actuator":
        return step.elements.get(tag, [])
    common = attribute is None or attribute.name in _common()
    tags = _actuators() if common else (tag,)
    return sorted((each for name in tags for each in step.elements.get(name, ())), key=_position)


def _position(node: Node) -> list[int]:
    """Return the position of a node in its document, for sorting."""
    at: list[int] = []
    parent = node.getparent()
    while parent is not None:
        at.insert(0, parent.index(node))
        node, parent = parent, parent.getparent()
    return at


@cache
def _actuators() -> tuple[str, ...]:
    paths = GRAMMAR.families["actuator"]
    return tuple(path.rpartition("/")[2] for path in paths)


@cache
def _common() -> frozenset[str]:
    """Return the attributes that any actuator of a class sets for all: those of a motor, which has none of its own."""
    return frozenset(GRAMMAR.element("actuator/motor").attributes)
