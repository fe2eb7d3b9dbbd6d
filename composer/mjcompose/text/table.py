"""Read a CSV file as a located tree: a mapping from the names in its first column to mappings by column."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.text.load import decode, load
from mjcompose.text.node import LINE_BREAK, Key, Mapping, Node, Scalar, Sequence, resolve

SUFFIX = ".csv"
_DELIMITERS = (",", ";", "\t")
_SYNTAX = "csv-syntax"
_QUOTED = re.compile(r'"[^"]*"')
_LEADING_ZERO = re.compile(r"[-+]?0[0-9]+")
"""A serial number or a name, such as `0042`: as a number, it would lose its zeros."""


class _Cell(NamedTuple):
    text: str
    span: Span


class _Unreadable(Exception):
    """Raised for a cell that cannot be read."""

    def __init__(self, message: str, span: Span) -> None:
        super().__init__(message)
        self.message = message
        self.span = span


def load_table(source: bytes, file: str, sink: Sink) -> Mapping | None:
    """Return the rows of a CSV file by name, each a mapping by column; `file` is its path for the user. No I/O.

    The first line has the names of the columns, and the first column has the names of the rows. A value has the type
    that it would have in YAML, with or without quotes, but whole numbers that begin with 0 are text; `[…]` is a list.
    An empty cell leaves a value out.
    """
    text = decode(source, file, sink)
    if text is None:
        return None
    try:
        lines = [cells for cells in _lines(text, file) if any(cell.text for cell in cells)]
    except _Unreadable as error:
        sink.error(_SYNTAX, error.message, error.span)
        return None
    if not lines:
        help = "write the names of the columns into the first line: `joint,kp,kd`"
        sink.error(_SYNTAX, f"`{file}` has no rows", Span(file, 1, 1), help=help)
        return None
    most = in_force().yaml_values
    if sum(map(len, lines)) > most:
        message = f"`{file}` has more than {most} values"
        sink.error("yaml-too-large", message, Span(file, 1, 1), help=advice("yaml-values"))
        return None
    header, *rows = lines
    before = sink.error_count
    columns = _columns(header, sink)
    entries: dict[str, tuple[Key, Node]] = {}
    for cells in rows:
        first = cells[0]
        if not first.text:
            sink.error(_SYNTAX, "this row has no name", first.span, help="write its name into the first column")
        elif (other := entries.get(first.text)) is not None:
            note = Note("the other one", other[0].span)
            sink.error("yaml-duplicate-key", f"`{first.text}` names two rows", first.span, notes=[note])
        else:
            entries[first.text] = Key(first.text, first.span), _row(cells, columns, sink)
    return Mapping(entries, header[0].span) if sink.error_count == before else None


def _columns(header: list[_Cell], sink: Sink) -> list[_Cell]:
    """Return the columns behind the names of rows, and report faulty ones."""
    seen: dict[str, _Cell] = {}
    columns = header[1:]
    while columns and not columns[-1].text:  # many programs end each line with a delimiter
        columns.pop()
    for cell in columns:
        if not cell.text:
            sink.error(_SYNTAX, "this column has no name", cell.span, help="write its name into the first line")
        elif (other := seen.get(cell.text)) is not None:
            note = Note("the other one", other.span)
            sink.error("yaml-duplicate-key", f"`{cell.text}` names two columns", cell.span, notes=[note])
        seen[cell.text] = cell
    return columns


def _row(cells: list[_Cell], columns: list[_Cell], sink: Sink) -> Mapping:
    entries: dict[str, tuple[Key, Node]] = {}
    for column, cell in zip(columns, cells[1:], strict=False):
        value = _value(cell, sink)
        if value is not None:
            entries[column.text] = Key(column.text, column.span), value
    surplus = next((cell for cell in cells[1 + len(columns) :] if cell.text), None)
    if surplus is not None:
        message = f"row `{cells[0].text}` has more values than there are columns"
        help = 'put a value with a delimiter in it into quotes: `"[0, 1]"`'
        sink.error(_SYNTAX, message, surplus.span, help=help)
    return Mapping(entries, cells[0].span)


def _value(cell: _Cell, sink: Sink) -> Node | None:
    """Return the value of a cell, or None if it has none."""
    if cell.text.startswith("["):
        inside = Sink()
        found = load(cell.text, cell.span.file, inside)
        if isinstance(found, Sequence) and not inside.has_errors:
            return _placed(found, cell.span)
    if _LEADING_ZERO.fullmatch(cell.text):
        return Scalar(cell.text, cell.span, cell.text, plain=False)
    try:
        value = resolve(cell.text)
    except OverflowError:
        sink.error("out-of-range", f"`{cell.text}` is too large for a number", cell.span)
        return None
    return None if value is None else Scalar(value, cell.span, cell.text, plain=not isinstance(value, str))


def _placed(node: Node, span: Span) -> Node:
    """Return the node with one place for everything in it."""
    if isinstance(node, Scalar):
        return Scalar(node.value, span, node.text, node.plain)
    if isinstance(node, Sequence):
        return Sequence(tuple(_placed(item, span) for item in node.items), span)
    return Mapping({name: (Key(name, span), _placed(each, span)) for name, (_, each) in node.entries.items()}, span)


def _delimiter(text: str) -> str:
    """Return the delimiter of the first line with content, in which quotes may contain other delimiters."""
    unquoted = _QUOTED.sub("", text.lstrip(" \r\n"))
    first = LINE_BREAK.split(unquoted, maxsplit=1)[0]
    return next((each for each in _DELIMITERS if each in first), _DELIMITERS[0])


def _lines(text: str, file: str) -> Iterator[list[_Cell]]:
    """Yield the cells of each line. A cell in quotes may have delimiters, line breaks and doubled quotes in it."""
    delimiter = _delimiter(text)
    pattern = re.compile(rf' *(?:"([^"]*(?:""[^"]*)*)" *|([^{delimiter}\r\n]*))({delimiter}|\r\n|\n|\r|\Z)')
    at = begin = 0
    line = 1
    cells: list[_Cell] = []
    while at < len(text):
        found = pattern.match(text, at)
        assert found is not None
        quoted, plain, end = found.groups()
        content = found[0][: len(found[0]) - len(end)]
        start = at + len(content) - len(content.lstrip(" "))
        last_break = max(content.rfind("\n"), content.rfind("\r"))
        width = len(content.rstrip(" ")) + at - start if last_break < 0 else 1
        column = start - begin + 1
        span = Span(file, line, column, end_line=line, end_column=column + max(width, 1))
        if plain is not None and plain.startswith('"'):
            raise _Unreadable("a quote has no end, or text follows it", span)
        cells.append(_Cell(plain.rstrip(" ") if quoted is None else quoted.replace('""', '"'), span))
        line += len(LINE_BREAK.findall(content))
        begin = begin if last_break < 0 else at + last_break + 1
        at = found.end()
        if end != delimiter:
            yield cells
            cells = []
            line += 1
            begin = at
    if cells:
        yield cells
