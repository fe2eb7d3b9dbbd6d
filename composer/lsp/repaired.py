"""The tree of a recipe that is being written: the line of the cursor is completed or left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from composer.diagnostics.sink import Sink
from composer.document import load
from composer.document.node import Mapping, Node
from composer.lsp.cursor import Cursor

_CLOSING = {"{": "}", "[": "]"}


def repaired(lines: Sequence[str], cursor: Cursor, last: Node | None) -> Node | None:
    """Return the tree of the text after the smallest change that makes it readable, or the last known tree.

    >>> from composer.lsp.cursor import cursor_at
    >>> lines = ["sensor:", "  push: {type: force, site: "]
    >>> tree = repaired(lines, cursor_at(lines, 1, 28), None)
    >>> isinstance(tree, Mapping) and list(tree.entries)
    ['sensor']
    """
    if not any(line.strip() and not line.lstrip().startswith("#") for line in lines):
        return None
    for text in _candidates(list(lines), cursor):
        tree = load(text, "", Sink())
        if isinstance(tree, Mapping):
            return tree
    return last


def _candidates(lines: list[str], cursor: Cursor) -> Iterator[str]:
    yield "\n".join(lines)
    at = cursor.line
    if at >= len(lines):
        return
    line, before, after = lines[at], lines[:at], lines[at + 1 :]
    if cursor.in_flow:
        for head in (line, line[: cursor.end], line[: cursor.start].rstrip().rstrip(",:")):
            yield "\n".join(
                [*before, head + cursor.quote * (head.count(cursor.quote) % 2) + _closers(head), *after]
            )
            yield "\n".join([*before, head + ": null" + _closers(head), *after])
    elif not cursor.has_colon:
        yield "\n".join([*before, line + ":", *after])
    yield "\n".join([*before, "", *after])
    yield "\n".join(before)


def _closers(line: str) -> str:
    """Return the brackets that close those that a line leaves open."""
    waiting: list[str] = []
    quote = ""
    for character in line:
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in _CLOSING:
            waiting.append(_CLOSING[character])
        elif waiting and character == waiting[-1]:
            waiting.pop()
    return "".join(reversed(waiting))
