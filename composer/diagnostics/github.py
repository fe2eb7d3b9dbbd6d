"""Diagnostics as GitHub workflow commands, which a pull request shows beside the lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from composer.diagnostics.cell_name import CellName, listed
from composer.diagnostics.diagnostic import Diagnostic, Severity
from composer.diagnostics.text import printable

_COMMAND = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def render(diagnostic: Diagnostic) -> str:
    """Return one workflow command on one line; notes and help follow the message.

    >>> render(Diagnostic("bad-name", "100% wrong"))
    '::error title=bad-name::100%25 wrong'
    """
    span = diagnostic.span
    properties: dict[str, str | int] = {}
    if span is not None:
        properties |= {"file": span.file, "line": span.line, "col": span.column}
        if span.end_line is not None:
            properties["endLine"] = span.end_line
        # GitHub accepts columns only within one line.
        if span.end_column is not None and span.end_line in (None, span.line):
            properties["endColumn"] = span.end_column
    cells = diagnostic.cells
    properties["title"] = diagnostic.code if not cells else f"{diagnostic.code} in {_counted(cells)}"

    lines = [diagnostic.message]
    for note in diagnostic.listed():
        lines.append(f"note: {note.span}: {note.message}" if note.span else f"note: {note.message}")
    if len(cells) > 1:
        lines.append(f"cells: {listed(cells)}")
    if diagnostic.recipes:
        lines.append(f"recipes: {', '.join(diagnostic.recipes)}")
    if diagnostic.help is not None:
        lines.append(f"help: {diagnostic.help}")
    return command(_COMMAND[diagnostic.severity], "\n".join(lines), properties)


def command(kind: str, message: str, properties: Mapping[str, str | int]) -> str:
    r"""Return a workflow command of a kind such as `error`, with everything escaped.

    >>> command("notice", "a%b", {"title": "c, d"})
    '::notice title=c%2C d::a%25b'
    """
    about = ",".join(f"{name}={_property(str(value))}" for name, value in properties.items())
    return f"::{kind} {about}::{_data(message)}"


def _counted(cells: Sequence[CellName]) -> str:
    return cells[0].name if len(cells) == 1 else f"{len(cells)} cells"


def _data(text: str) -> str:
    return printable(text).replace("%", "%25").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
