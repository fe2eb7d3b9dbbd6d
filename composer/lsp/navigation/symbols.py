"""Document symbols: the outline of a recipe with its sections, parts and elements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node, Scalar, Sequence, find, spans
from composer.lsp.analysis import Analysis
from composer.lsp.answers import Symbol

_DEPTH = 4
_TELLING = ("model", "type", "to", "select", "default")
_NAMING = ("name", "id", "to")


def symbols(analysis: Analysis) -> list[Symbol]:
    """Return the outline down to elements and their settings; of half-written text, what can be read."""
    found = _of(analysis.tree, 0) if isinstance(analysis.tree, Mapping) else ()
    return list(_standing(found, analysis))


def _standing(found: Iterable[Symbol], analysis: Analysis) -> Iterator[Symbol]:
    for each in found:
        span, whole = (analysis.now(place, analysis.tree_of) for place in (each.span, each.whole))
        if span is not None:
            yield replace(
                each, span=span, whole=whole or span, children=tuple(_standing(each.children, analysis))
            )


def _of(node: Node, depth: int) -> Iterator[Symbol]:
    if depth >= _DEPTH:
        return
    if isinstance(node, Mapping):
        for name, (key, value) in node.entries.items():
            kind = "section" if depth == 0 else "value" if isinstance(value, Scalar) else "element"
            whole = _around(key.span, value)
            yield Symbol(name, kind, key.span, whole, _detail(value), tuple(_of(value, depth + 1)))
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            if not isinstance(item, Scalar):
                yield Symbol(_label(item, index), "element", item.span, _around(item.span, item), _detail(item),
                             tuple(_of(item, depth + 1)))  # fmt: skip


def _around(first: Span, node: Node) -> Span:
    """Return the span from a place to the end of a value."""
    line, column = first.end_line or first.line, first.end_column or first.column
    for span in spans(node):
        end = span.end_line or span.line, span.end_column or span.column
        if span.file == first.file and end > (line, column):
            line, column = end
    return replace(first, end_line=line, end_column=column)


def _label(node: Node, index: int) -> str:
    for key in _NAMING:
        found = find(node, (key,))
        if isinstance(found, Scalar):
            return found.text
    return f"[{index}]"


def _detail(node: Node) -> str:
    if isinstance(node, Scalar):
        return node.text if len(node.text) <= 60 else f"{node.text[:59]}…"
    found = (find(node, (key,)) for key in _TELLING)
    return next((each.text for each in found if isinstance(each, Scalar)), "")
