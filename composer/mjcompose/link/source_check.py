"""Check that a model file is valid MJCF, because linking can hide errors that MuJoCo would report.

Sections of settings are joined, a part's root is unwrapped, and options give way to those of the recipe. Inside
`<frame>` and `<replicate>`, where parts are attached, MuJoCo's reader ignores unknown elements and attributes (4.0:
`<frame><geom mode="x" size="1"/></frame>` compiles, `<geom mode="x" size="1"/>` does not). What MuJoCo ignores in
the file itself is not an error here: `tree/ignored.py` reports it as a warning.

The check takes longer than parsing and linking a file (2 ms for 250 elements, against 1.7 ms). Verified builds run
it first; other builds run it only after the linker has raised an exception. Even then the fault may not be the
cause: the work is repeated with the faults corrected, and if it still raises, the exception is a bug and is raised.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.link.settings import ROOM
from mjcompose.model.classes import MAIN
from mjcompose.model.grammar import GRAMMAR, Attribute, ElementType, version_key
from mjcompose.model.unit import Unit
from mjcompose.model.values import Refusal, check_value
from mjcompose.model.xml_faults import BLIND, unread
from mjcompose.mujoco.messages import unknown_attribute, unknown_element, version_of

INVALID_SOURCE = (ValueError, IndexError, KeyError, OverflowError, ZeroDivisionError)
"""What reading a source that is not MJCF may raise. Of one that is it is a bug."""

_FREE = frozenset({"string", "file", "name", "reference", "references"})
"""Types of attributes of which every text is a value."""
# Numbers as almost everybody writes them: most of the values there are, and four times as fast to see.
_PLAIN = re.compile(r"-?[0-9.]+(?: -?[0-9.]+)*", re.ASCII)


@dataclass(frozen=True, slots=True)
class _Malformed:
    node: Node
    attribute: Attribute
    refusal: Refusal

    def report(self, unit: Unit, sink: Sink) -> None:
        name = self.attribute.name
        code = "wrong-keyword" if self.attribute.type in ("keyword", "keywords") else "wrong-type"
        message = f"`{name}` of `<{self.node.tag}>` {self.refusal.message}"
        sink.error(code, message, unit.origins.span(self.node, unit.file, name), help=self.refusal.advice)

    def repair(self) -> None:
        self.node.set(self.attribute.name, _sample(self.attribute))


@dataclass(frozen=True, slots=True)
class _UnknownAttribute:
    node: Node
    name: str
    version: str | None = None

    def report(self, unit: Unit, sink: Sink) -> None:
        found = unknown_attribute(self.node, self.name, unit.file, version=self.version).diagnostic
        span = unit.origins.span(self.node, unit.file, self.name, key=True)
        sink.add(replace(found, span=span))

    def repair(self) -> None:
        del self.node.attrib[self.name]


@dataclass(frozen=True, slots=True)
class _Misnamed:
    """A name that MuJoCo reserves; adding a prefix would hide the error."""

    node: Node
    name: str
    message: str
    help: str

    def report(self, unit: Unit, sink: Sink) -> None:
        span = unit.origins.span(self.node, unit.file, self.name)
        sink.error("bad-name", self.message, span, help=self.help)

    def repair(self) -> None:
        if self.name != "class":
            self.node.set(self.name, "another world")
        else:
            is_top = (above := self.node.getparent()) is None or above.tag != "default"
            self.node.set(self.name, MAIN if is_top else "another class")


@dataclass(frozen=True, slots=True)
class _RepeatedKey:
    """A key with the same name as another key of its file; linking would merge the two."""

    node: Node
    first: Node

    def report(self, unit: Unit, sink: Sink) -> None:
        note = Note("the other one is here", unit.origins.span(self.first, unit.file, "name"))
        sink.error(
            "name-clash",
            f"two keys are called `{self.node.get('name')}`",
            unit.origins.span(self.node, unit.file, "name"),
            notes=(note,),
            help="give one of them another name",
        )

    def repair(self) -> None:
        _remove(self.node)


@dataclass(frozen=True, slots=True)
class _RepeatedClass:
    """A class of the same name as another one; that of the top is `main`, written or not."""

    node: Node
    first: Node

    def report(self, unit: Unit, sink: Sink) -> None:
        note = Note("the other one is here", unit.origins.span(self.first, unit.file, "class"))
        sink.error(
            "class-clash",
            f"two classes are called `{self.node.get('class')}`",
            unit.origins.span(self.node, unit.file, "class"),
            notes=(note,),
            help="give one of them another name",
        )

    def repair(self) -> None:
        _remove(self.node)


@dataclass(frozen=True, slots=True)
class _UnknownElement:
    node: Node
    version: str | None = None

    def report(self, unit: Unit, sink: Sink) -> None:
        found = unknown_element(self.node, unit.file, self.version).diagnostic
        span = unit.origins.span(self.node, unit.file)
        sink.add(replace(found, span=span))

    def repair(self) -> None:
        _remove(self.node)


@dataclass(frozen=True, slots=True)
class _TooMany:
    node: Node
    most: int

    def report(self, unit: Unit, sink: Sink) -> None:
        parent = self.node.getparent()
        assert parent is not None
        how_many = "one" if self.most == 1 else str(self.most)
        message = f"MuJoCo takes {how_many} `<{self.node.tag}>` in `<{parent.tag}>`, and this is another one"
        span = unit.origins.span(self.node, unit.file)
        sink.error("wrong-length", message, span, help="join them, or take one out")

    def repair(self) -> None:
        _remove(self.node)


@dataclass(frozen=True, slots=True)
class _Clashing:
    """Attributes that exclude one another. If one of them counts, which one depends on the reader."""

    node: Node
    names: tuple[str, ...]

    def report(self, unit: Unit, sink: Sink) -> None:
        *others, last = (f"`{name}`" for name in self.names)
        message = f"`<{self.node.tag}>` has {', '.join(others)} and {last}, of which MuJoCo takes only one"
        span = unit.origins.span(self.node, unit.file, self.names[-1], key=True)
        sink.error("wrong-length", message, span, help=f"take {last} or the other out")

    def repair(self) -> None:
        for name in self.names[1:]:
            del self.node.attrib[name]


_Fault = (
    _Malformed | _UnknownAttribute | _Misnamed | _RepeatedKey | _RepeatedClass | _UnknownElement | _TooMany | _Clashing
)


def check_source(unit: Unit, sink: Sink) -> bool:
    """Report elements, attributes and values of a file that MJCF does not have. Return whether there are none.

    The unit is that of the file as it is: in one that was being linked the fault may be gone already.
    """
    found = list(_faults(unit.root))
    if found:
        passed_over = set(unread(unit.root))
        found = [each for each in found if _what(each) not in passed_over]
    version = version_of(_what(each) for each in found if isinstance(each, _UnknownAttribute | _UnknownElement))
    for fault in found:
        if isinstance(fault, _UnknownAttribute | _UnknownElement):
            fault = replace(fault, version=version)
        fault.report(unit, sink)
    return not found


def _of_classes(root: Node) -> Iterator[_RepeatedClass]:
    """MuJoCo 4.0: `repeated default class name`. In a part `main` becomes another name, and nothing would repeat it."""
    classes: dict[str, Node] = {}
    for section in root.iterchildren("default"):
        classes.setdefault(MAIN, section)
        for nested in section.iterfind(".//default"):
            name = str(nested.get("class") or "")
            if name and classes.setdefault(name, nested) is not nested:
                yield _RepeatedClass(nested, classes[name])


def _what(fault: _Fault) -> tuple[Node, str | None]:
    """Return the element of a fault, and the name of its attribute if the attribute is unknown."""
    return fault.node, fault.name if isinstance(fault, _UnknownAttribute) else None


def repair(unit: Unit) -> None:
    """Remove what MJCF does not have, and replace the values of malformed attributes by arbitrary valid ones."""
    for fault in list(_faults(unit.root)):
        fault.repair()


def _faults(root: Node) -> Iterator[_Fault]:
    keys: dict[str, Node] = {}
    for key in root.iterfind("keyframe/key"):
        name = str(key.get("name") or "")
        if name and keys.setdefault(name, key) is not key:
            yield _RepeatedKey(key, keys[name])
    yield from _of_classes(root)
    waiting = [(root, GRAMMAR.root)]
    while waiting:
        node, kind = waiting.pop()
        yield from _of_attributes(node, kind)
        if kind.constraints and len(node.attrib) > 1 and _is_checked(node):
            yield from _of_constraints(node, kind)
        yield from _of_name(node, kind)
        if not len(node):
            continue
        known, below = kind.children, []
        for child in node.iterchildren("*"):
            if child.tag in known:
                below.append((child, known[child.tag]))
            else:
                yield _UnknownElement(child)
        if len(below) > 1 and kind is not GRAMMAR.root:  # MuJoCo joins sections, however many there are
            yield from _too_many(below)
        waiting += reversed(below)


def _of_attributes(node: Node, kind: ElementType) -> Iterator[_Fault]:
    known = kind.attributes
    for name, value in node.items():
        attribute = known.get(str(name))
        if attribute is None:
            if name not in kind.ignored and not _is_newer():
                yield _UnknownAttribute(node, str(name))
        elif node.tag == "size" and name in ROOM and not value.strip():
            # MuJoCo 4.0 passes over blanks in place of numbers, but not in these.
            yield _Malformed(node, attribute, Refusal("is empty"))
        elif attribute.type not in _FREE and not _is_plain(attribute, str(value)):
            refusal = check_value(attribute, str(value))
            if refusal is not None:
                yield _Malformed(node, attribute, refusal)


def _is_checked(node: Node) -> bool:
    """Return whether MuJoCo (3.12 to 4.0) checks the rules for an element of a body here. Inside a frame it does not.

    A part ends up in one. What is not of the body tree is looked at in the composition, too.
    """
    around = {str(each.tag) for each in node.iterancestors()}
    return "worldbody" in around and around.isdisjoint(BLIND)


def _of_constraints(node: Node, kind: ElementType) -> Iterator[_Clashing]:
    for rule in kind.constraints:
        written = tuple(name for (name,) in rule.bundles if name in node.attrib) if rule.kind == "exclusive" else ()
        if len(written) > 1:
            yield _Clashing(node, written)


def _of_name(node: Node, kind: ElementType) -> Iterator[_Misnamed]:
    if kind.path == "body" and node.get("name") == "world":
        message = "a body cannot be called `world`, which is the name of the world itself"
        yield _Misnamed(node, "name", message, help="give it another name")
    elif kind.path == "default":
        parent, name = node.getparent(), node.get("class")
        if parent is None or parent.tag == "default":
            if not name:
                yield _Misnamed(node, "class", "a default class inside another has no name", help='write `class="…"`')
        elif name not in (None, "", "main"):
            message = f"a default class at the top is called `main`, and not `{name}`"
            yield _Misnamed(node, "class", message, help=f'put it into one: `<default><default class="{name}">`')


def _is_newer() -> bool:
    """Return whether this MuJoCo may have attributes that the grammar does not know yet."""
    return _installed() > version_key(GRAMMAR.versions[-1])


@cache
def _installed() -> tuple[int, ...]:
    from importlib import metadata  # few models have an attribute that is not known

    try:
        return version_key(metadata.version("mujoco"))
    except metadata.PackageNotFoundError:
        return ()


def _is_plain(attribute: Attribute, value: str) -> bool:
    """Return whether a value is a valid count of plain numbers. If not, it may still be valid."""
    if attribute.type != "real" or attribute.lengths is not None or not _PLAIN.fullmatch(value):
        return False
    parts = value.split(" ")
    try:
        list(map(float, parts))
    except ValueError:
        return False
    low, high = attribute.min_length, attribute.max_length
    return (low or 0) <= len(parts) and (high is None or len(parts) <= high)


def _too_many(children: list[tuple[Node, ElementType]]) -> Iterator[_TooMany]:
    counts: Counter[str] = Counter()
    for child, kind in children:
        counts[kind.tag] += 1
        if kind.max_count is not None and counts[kind.tag] > kind.max_count:
            yield _TooMany(child, kind.max_count)


def _remove(node: Node) -> None:
    parent = node.getparent()
    if parent is not None:
        parent.remove(node)


def _sample(attribute: Attribute) -> str:
    """Return a valid value of an attribute.

    >>> _sample(GRAMMAR.element("geom").attributes["pos"])
    '1 1 1'
    """
    if attribute.type == "bool":
        return "true"
    if attribute.keywords:
        return attribute.keywords[0]
    count = attribute.lengths[0] if attribute.lengths else attribute.min_length or 1
    return "xyz"[:count] if attribute.type == "chars" else " ".join(["1"] * count)
