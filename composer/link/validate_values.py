"""Values in sources that MuJoCo cannot read either, looked for where the linker has stumbled over one.

The linker reads only what it has to rewrite, and as it comes: to check every value of every source beforehand takes
longer than to parse and link it (2 ms for 250 elements, against 1.7 ms). That one of them is the reason is not taken
for granted: with these values put right the work must raise nothing, or else the exception is a bug and is raised.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.grammar.check import check_value
from composer.grammar.refusal import Refusal
from composer.tree.unit import Unit

STUMBLES = (ValueError, IndexError, KeyError, OverflowError, ZeroDivisionError)
"""What reading a malformed value may raise. Where none is malformed it is a bug."""


def malformed(units: Iterable[Unit], sink: Sink) -> bool:
    """Report every value that is not what its attribute takes; whether there was any.

    The units are those of the files as they are: in one that was being linked the value may be gone already.
    """
    before = sink.error_count
    for unit in units:
        for element, attribute, refusal in _refused(unit):
            code = "wrong-keyword" if attribute.type in ("keyword", "keywords") else "wrong-type"
            span = unit.origins.span(element, unit.file, attribute.name)
            message = f"`{attribute.name}` of `<{element.tag}>` {refusal.message}"
            sink.error(code, message, span, help=refusal.advice)
    return sink.error_count > before


def put_right(unit: Unit) -> None:
    """Give every attribute whose value is malformed a value that it takes, whichever."""
    for element, attribute, _ in _refused(unit):
        element.set(attribute.name, _sample(attribute))


def _sample(attribute: Attribute) -> str:
    """A value that an attribute takes.

    >>> _sample(GRAMMAR.element("geom").attributes["pos"])
    '1 1 1'
    """
    if attribute.type == "bool":
        return "true"
    if attribute.keywords:
        return attribute.keywords[0]
    count = attribute.lengths[0] if attribute.lengths else attribute.min_length or 1
    return "xyz"[:count] if attribute.type == "chars" else " ".join(["1"] * count)


def _refused(unit: Unit) -> list[tuple[Node, Attribute, Refusal]]:
    found = ((*each, check_value(each[1], str(each[0].get(each[1].name)))) for each in _values(unit.root))
    return [(element, attribute, refusal) for element, attribute, refusal in found if refusal is not None]


def _values(root: Node) -> Iterator[tuple[Node, Attribute]]:
    stack = [(root, GRAMMAR.root)]
    while stack:
        element, kind = stack.pop()
        for name in element.keys():  # noqa: SIM118 (an element is no mapping)
            attribute = kind.attributes.get(str(name))
            if attribute is not None:
                yield element, attribute
        for child in element.iterchildren("*"):
            child_kind = kind.children.get(str(child.tag))
            if child_kind is not None:
                stack.append((child, child_kind))
