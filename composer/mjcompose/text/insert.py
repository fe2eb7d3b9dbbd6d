"""Changes to the text of a recipe that keep its layout and its comments."""

from __future__ import annotations

import re
from collections.abc import Iterable
from collections.abc import Sequence as Lines

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Span
from mjcompose.text.node import Mapping, Node, Sequence, find, spans

_LINE_BREAK = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True, slots=True)
class Change:
    """A replacement of a stretch of text. With an empty span, the text is inserted there."""

    span: Span
    text: str


def lines_of(text: str) -> list[str]:
    """Return the lines without their ends. `str.splitlines` also splits at characters that editors and YAML do not."""
    return _LINE_BREAK.split(text)


def with_key(tree: Mapping, lines: Lines[str], file: str, path: tuple[str | int, ...], value: str) -> Change | None:
    """Return the change that writes `path: value` with the missing keys, or None if the path leads through a value."""
    holder: Node = tree
    for depth, step in enumerate(path):
        if not isinstance(holder, Mapping):
            return None
        below = find(holder, (step,))
        if below is None:
            *outer, last = map(str, path[depth:])
            text = "".join(f"{step}: {{" for step in outer) + f"{last}: {value}" + "}" * len(outer)
            return added_key(holder, lines, file, text, top=depth == 0)
        holder = below
    if holder.span.end_column is None or isinstance(holder, Mapping | Sequence):
        return None
    return Change(holder.span, value)


def with_item(tree: Mapping, lines: Lines[str], file: str, key: str, value: str) -> Change | None:
    """Return the change that appends a value to the list below a key of the recipe, or creates the list; or None."""
    found = tree.entries.get(key)
    if found is None:
        return added_key(tree, lines, file, f"{key}: [{value}]", top=True)
    node = found[1]
    if not isinstance(node, Sequence) or not node.items:
        return None
    last = node.items[-1].span
    if _is_flow(node, lines):
        return _insert(file, last.end_line or last.line, last.end_column or last.column, f", {value}")
    line, indent = last.line, lines[last.line - 1].index("-")
    return _insert(file, line, len(lines[line - 1]) + 1, f"\n{' ' * indent}- {value}")


def added_key(holder: Mapping, lines: Lines[str], file: str, text: str, top: bool) -> Change:
    if not top and _is_flow(holder, lines):
        line, column = _end(holder, file)
        at = lines[line - 1].find("}", column - 1) + 1 or column
        return _insert(file, line, at, f", {text}" if holder.entries else text)
    line, _ = _end(holder, file)
    while line < len(lines) and lines[line].strip() and lines[line].startswith(" ") and top:
        line += 1  # in a block of text: the tree knows only its first line
    first = next(iter(holder.entries.values()), None)
    indent = 0 if top or first is None else first[0].span.column - 1
    return _insert(file, line, len(lines[line - 1]) + 1, f"\n{' ' * indent}{text}")


def _is_flow(node: Node, lines: Lines[str]) -> bool:
    row = lines[node.span.line - 1] if node.span.line <= len(lines) else ""
    return row[node.span.column - 1 : node.span.column] in ("{", "[")


def _end(node: Node, file: str) -> tuple[int, int]:
    own = [span for span in spans(node) if span.file == file]
    return max((each.end_line or each.line, each.end_column or each.column) for each in own[1:] or own)


def _insert(file: str, line: int, column: int, text: str) -> Change:
    return Change(Span(file, line, column, line, column), text)


def changed(text: str, changes: Iterable[Change]) -> str:
    r"""Return the text with changes that do not overlap.

    >>> changed("a: 1\nb: 2\n", [Change(Span("", 2, 4, 2, 5), "3"), Change(Span("", 1, 5, 1, 5), "\nc: 4")])
    'a: 1\nc: 4\nb: 3\n'
    """
    starts = [0, *(found.end() for found in _LINE_BREAK.finditer(text))]
    for each in sorted(changes, key=lambda each: (each.span.line, each.span.column), reverse=True):
        line, column = each.span.line, each.span.column
        end = starts[(each.span.end_line or line) - 1] + (each.span.end_column or column) - 1
        text = text[: starts[line - 1] + column - 1] + each.text + text[end:]
    return text
