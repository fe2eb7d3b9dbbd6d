"""Values in sources that MuJoCo cannot read either, looked for where the linker has stumbled over one.

The linker reads only what it has to rewrite, and as it comes: to check every value of every source beforehand would
cost more than all passes together.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.grammar.check import check_value
from composer.tree.unit import Unit

STUMBLES = (ValueError, IndexError, KeyError, OverflowError, ZeroDivisionError)
"""What reading a malformed value may raise. Where none is malformed it is a bug."""


def malformed(units: Iterable[Unit], sink: Sink) -> bool:
    """Tell every value that is not what its attribute takes; whether there was any.

    The units are those of the files as they are: in one that was being linked the value may be gone already.
    """
    before = sink.error_count
    for unit in units:
        for element, attribute in _values(unit.root):
            answer = check_value(attribute, str(element.get(attribute.name)))
            if answer is not None:
                code = "wrong-keyword" if attribute.type in ("keyword", "keywords") else "wrong-type"
                span = unit.origins.span(element, unit.file, attribute.name)
                sink.error(
                    code,
                    f"`{attribute.name}` of `<{element.tag}>` {answer.message}",
                    span,
                    help=answer.advice,
                )
    return sink.error_count > before


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
