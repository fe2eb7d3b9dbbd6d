"""Evaluate expressions in a recipe, except those that depend on elements."""

from __future__ import annotations

from collections.abc import Mapping as Map
from typing import TYPE_CHECKING

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.unknown import unknown_name
from composer.document.node import Key, Mapping, Node, Scalar, Sequence
from composer.document.piece import Path, is_of_elements
from composer.expand.plain import node_of
from composer.expr.error import ExpressionError, UnknownName
from composer.expr.opening import is_template
from composer.expr.value import Value, shown

if TYPE_CHECKING:
    from composer.expand.parameter import Parameter


class Substitution:
    """Evaluates the expressions of nodes.

    `lost` has the keys and texts that were left out because an expression in them is faulty, `gone` the paths of
    these keys.
    """

    def __init__(
        self, scope: Map[str, Value], parameters: Map[str, Parameter], broken: frozenset[str], sink: Sink
    ) -> None:
        self.scope, self.parameters, self.broken, self.sink = scope, parameters, broken, sink
        self.lost: set[str] = set()
        self.gone: set[Path] = set()

    def of(self, node: Node, path: Path = ()) -> Node | None:
        """Return the node with its expressions evaluated, or None if its own value is faulty."""
        if is_of_elements(path):  # evaluated later, for each element
            return node
        if isinstance(node, Scalar):
            return self._scalar(node)
        if isinstance(node, Sequence):
            items = [self.of(item, (*path, index)) for index, item in enumerate(node.items)]
            if any(item is None for item in items):  # a list without one of its values would be another list
                return None
            return Sequence(tuple(item for item in items if item is not None), node.span)
        entries: dict[str, tuple[Key, Node]] = {}
        for name, (key, value) in node.entries.items():
            found = self.of(value, (*path, name))
            if found is None:
                self.lost.add(name)
                self.gone.add((*path, name))
            else:
                entries[name] = (key, found)
        return Mapping(entries, node.span)

    def _scalar(self, node: Scalar) -> Node | None:
        if not isinstance(node.value, str) or not is_template(node.value):
            return node
        from composer.expr.template import Template  # most recipes have no expression

        try:
            template = Template.parse(node.value)
            value = template.value(self.scope)
        except ExpressionError as error:
            self.lost.add(node.text)
            report(error, node, [*self.scope], broken=self.broken, sink=self.sink)
            return None
        alone = self.parameters.get(template.is_one_name or "")
        if alone is not None and alone.is_angle and isinstance(value, (int, float)):
            value = f"{shown(value)}{alone.unit}"
        return node_of(value, node.span)


def report(
    error: ExpressionError, node: Scalar, known: list[str], broken: frozenset[str], sink: Sink
) -> None:
    """Report an error in an expression, at its place in the scalar; errors about a `broken` name are follow-ups."""
    if isinstance(error, UnknownName) and error.name in broken:
        return
    span = within(node, error.start, error.end)
    if not isinstance(error, UnknownName):
        sink.error("expression", error.message, span, help=error.help)
        return
    declared = f"declare it: `params: {{{error.name}: …}}`"
    sink.add(unknown_name("parameter", error.name, known, span=span, otherwise=declared))


def within(node: Scalar, start: int, end: int) -> Span:
    """Return the place of some characters of a scalar's text.

    It is the place of the whole scalar if the file writes the characters differently.
    """
    span = node.span
    if span.end_line not in (None, span.line) or span.end_column is None:
        return span
    quotes = span.end_column - span.column - len(node.text)
    if quotes not in (0, 2):
        return span
    first = span.column + quotes // 2
    return Span(
        span.file, span.line, first + start, end_line=span.line, end_column=first + max(end, start + 1)
    )
