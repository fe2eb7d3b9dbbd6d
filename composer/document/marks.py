"""Convert the marks of YAML events to spans."""

from __future__ import annotations

import re
from typing import Any

from composer.diagnostics import Span

_PROPERTIES = re.compile(r"(?:[&!]\S*[ \t]+)+")
_TAG = re.compile(r"(?:&\S+\s+)?(!<[^>\s]*>|![^\s,\[\]{}]*)")
_BLOCK_HEADER = re.compile(r"[|>][-+0-9]*")
_REST_OF_LINE = re.compile(r"[^\r\n]*")


class Marks:
    """Finds the places of events in `text`."""

    __slots__ = ("file", "text")

    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file

    def span(self, event: Any) -> Span:
        """Return the place of an event without anchor and tag; if it has several lines, the first."""
        start, end = event.start_mark, event.end_mark
        line, column = start.line + 1, start.column + 1
        if end.line + 1 == line:
            last = end.column + 1
        else:
            header = _BLOCK_HEADER if getattr(event, "style", None) in ("|", ">") else _REST_OF_LINE
            found = header.match(self.text, start.index) or _REST_OF_LINE.match(self.text, start.index)
            last = column + (len(found.group().rstrip()) if found else 0)
        if getattr(event, "tag", None) is not None or getattr(event, "anchor", None) is not None:
            column = min(column + self.properties(event), last)
        return Span(self.file, line, column, end_line=line, end_column=last)

    def block(self, event: Any) -> tuple[int, int] | None:
        """Return where the text of a literal block begins, as line and column; None for all other scalars."""
        if event.style != "|":
            return None
        written = self.text[event.start_mark.index : event.end_mark.index].splitlines()[1:]
        indent = next((len(line) - len(line.lstrip(" ")) for line in written if line.strip()), 0)
        return event.start_mark.line + 2, indent + 1

    def properties(self, event: Any) -> int:
        """Return the number of characters for anchor and tag before the value, if it follows on their line."""
        found = _PROPERTIES.match(self.text, event.start_mark.index)
        return len(found.group()) if found else 0

    def tag(self, event: Any) -> Span:
        """Return the place of an event's tag."""
        found = _TAG.match(self.text, event.start_mark.index)
        line, column = event.start_mark.line + 1, event.start_mark.column + 1
        if found is None or "\n" in found.group():
            return Span(self.file, line, column, end_line=line, end_column=column + 1)
        column += found.start(1) - found.start()
        return Span(self.file, line, column, end_line=line, end_column=column + len(found.group(1)))
