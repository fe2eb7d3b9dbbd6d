"""Diagnostics as GitHub workflow commands, which a pull request shows beside the lines they speak of."""

from __future__ import annotations

from composer.diagnostics.diagnostic import Diagnostic, Severity

_COMMAND = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def render(diagnostic: Diagnostic) -> str:
    """One workflow command on one line; notes and help follow the message in its text.

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
    properties["title"] = diagnostic.code

    lines = [diagnostic.message]
    for note in diagnostic.listed():
        lines.append(f"note: {note.span}: {note.message}" if note.span else f"note: {note.message}")
    if diagnostic.help is not None:
        lines.append(f"help: {diagnostic.help}")
    listed = ",".join(f"{name}={_property(str(value))}" for name, value in properties.items())
    return f"::{_COMMAND[diagnostic.severity]} {listed}::{_data(chr(10).join(lines))}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
