"""Insert text into a recipe in its own style: a key into a mapping, or an item into a list."""

from __future__ import annotations

from collections.abc import Sequence as Lines

from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node, Sequence, find, spans
from composer.lsp.answers import Change
from composer.lsp.cursor import Path


def with_key(tree: Mapping, lines: Lines[str], file: str, path: Path, value: str) -> Change | None:
    """Return the change that writes `path: value` and the missing keys on the way.

    A value on one line is replaced. The result is None if the path leads through something that is no mapping.

    >>> from composer.diagnostics.sink import Sink
    >>> from composer.document import load
    >>> text = "option: {cone: elliptic}"
    >>> with_key(load(text, "a", Sink()), [text], "a", ("option", "impratio"), "10").text
    ', impratio: 10'
    """
    holder: Node = tree
    for depth, step in enumerate(path):
        if not isinstance(holder, Mapping):
            return None
        below = find(holder, (step,))
        if below is None:
            return _added(holder, lines, file, _nested(path[depth:], value), top=depth == 0)
        holder = below
    if holder.span.end_column is None or isinstance(holder, Mapping | Sequence):
        return None
    return Change(holder.span, value)


def with_item(tree: Mapping, lines: Lines[str], file: str, key: str, value: str) -> Change | None:
    """Return the change that appends a value to the list below a key of the recipe, or None.

    The list is created if needed.
    """
    found = tree.entries.get(key)
    if found is None:
        return _added(tree, lines, file, f"{key}: [{value}]", top=True)
    node = found[1]
    if not isinstance(node, Sequence) or not node.items:
        return None
    last = node.items[-1].span
    if _is_flow(node, lines):
        return _insert(file, last.end_line or last.line, last.end_column or last.column, f", {value}")
    line, indent = last.line, lines[last.line - 1].index("-")
    return _insert(file, line, len(lines[line - 1]) + 1, f"\n{' ' * indent}- {value}")


def _nested(path: Path, value: str) -> str:
    *outer, last = map(str, path)
    text = f"{last}: {value}"
    for step in reversed(outer):
        text = f"{step}: {{{text}}}"
    return text


def _added(holder: Mapping, lines: Lines[str], file: str, text: str, top: bool) -> Change:
    """Return the change that adds an entry at the end of a mapping."""
    if not top and _is_flow(holder, lines):
        line, column = _end(holder, file)
        row = lines[line - 1]
        closing = row.find("}", column - 1)
        at = closing + 1 if closing >= 0 else column
        empty = not holder.entries
        return _insert(file, line, at, text if empty else f", {text}")
    line, _ = _end(holder, file)
    while line < len(lines) and lines[line].strip() and lines[line].startswith(" ") and top:
        line += 1  # a block of text, of which the tree knows the first line alone
    first = next(iter(holder.entries.values()), None)
    indent = 0 if top or first is None else first[0].span.column - 1
    return _insert(file, line, len(lines[line - 1]) + 1, f"\n{' ' * indent}{text}")


def _is_flow(node: Node, lines: Lines[str]) -> bool:
    row = lines[node.span.line - 1] if node.span.line <= len(lines) else ""
    return row[node.span.column - 1 : node.span.column] in ("{", "[")


def _end(node: Node, file: str) -> tuple[int, int]:
    """Return where the last item of a value ends."""
    own = [span for span in spans(node) if span.file == file]
    return max((each.end_line or each.line, each.end_column or each.column) for each in own[1:] or own)


def _insert(file: str, line: int, column: int, text: str) -> Change:
    return Change(Span(file, line, column, line, column), text)
