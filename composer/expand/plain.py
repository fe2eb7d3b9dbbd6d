"""Convert located nodes to values of expressions, and back."""

from __future__ import annotations

from composer.diagnostics.span import Span
from composer.document.node import Node, Scalar, Sequence
from composer.expr.value import Value, shown


def plain(node: Node) -> Value | None:
    """Return the value of a scalar or a list of scalars; None for null, mappings, and other values."""
    if isinstance(node, Scalar):
        return node.value
    if isinstance(node, Sequence):
        items = tuple(value for item in node.items if (value := plain(item)) is not None)
        return items if len(items) == len(node.items) else None
    return None


def node_of(value: Value, span: Span) -> Node:
    """Return a node with this value and place."""
    if isinstance(value, tuple):
        return Sequence(tuple(node_of(each, span) for each in value), span)
    return Scalar(value, span, shown(value), plain=not isinstance(value, str))


def same(a: Value, b: Value) -> bool:
    """Return whether two values are equal; `true` is not 1.

    >>> same(1, 1.0), same(True, 1), same((1, 2), (1.0, 2))
    (True, False, True)
    """
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    return isinstance(a, bool) == isinstance(b, bool) and a == b
