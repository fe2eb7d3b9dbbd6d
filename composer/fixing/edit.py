"""Convert the fix of a diagnostic to a change of its file's text."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.fix import Fix
from composer.diagnostics.span import Span
from composer.document.quote import quoted, word

RECIPES = (".yaml", ".yml")
_LINE_BREAK = re.compile(r"\r\n|\n|\r")
_QUOTES = ("'", '"')
_CLOSING = {"[": "]", "{": "}"}


@dataclass(frozen=True, slots=True)
class Edit:
    """Replaces the characters from `start` up to `end` by `text`."""

    start: int
    end: int
    text: str


def edit_of(diagnostic: Diagnostic, source: str) -> Edit | None:
    """Return the change to a file's text for a diagnostic's fix, or None if there is none or it does not fit.

    >>> span = Span("a.yaml", 1, 7, 1, 13)
    >>> edit_of(Diagnostic("unknown-name", "no", span, fix=Fix("arm/tip", "tipp")), 'site: "tipp"')
    Edit(start=6, end=12, text='"arm/tip"')
    >>> edit_of(Diagnostic("unknown-name", "no", span, fix=Fix("tip", "tipp")), 'site: "other"')
    """
    fix, span = diagnostic.fix, place_of(diagnostic)
    if fix is None or span is None:
        return None
    bounds = _bounds(span, source)
    if bounds is None:
        return None
    start, end = bounds
    written = source[start:end]
    text = fix.replacement if fix.replaces is None else _renamed(written, fix, span.file.endswith(RECIPES))
    # The span of a list over several lines ends with its first line.
    if text is None or (
        fix.replaces is None and written[:1] in _CLOSING and written[-1] != _CLOSING[written[0]]
    ):
        return None
    return Edit(start, end, text)


def exact(diagnostic: Diagnostic, source: str) -> Diagnostic:
    """Return the diagnostic with the verbatim text of its fix, including quotes; without a fix that does not fit."""
    if diagnostic.fix is None:
        return diagnostic
    edit = edit_of(diagnostic, source)
    fix = None if edit is None else Fix(edit.text, None, place_of(diagnostic))
    return replace(diagnostic, fix=fix)


def place_of(diagnostic: Diagnostic) -> Span | None:
    """Return where the fix of a diagnostic applies."""
    return diagnostic.fix.span or diagnostic.span if diagnostic.fix is not None else None


def applied(source: str, edits: Iterable[Edit]) -> str:
    """Return the text with all changes; if two overlap, with the first.

    >>> applied("a b c", [Edit(0, 1, "x"), Edit(4, 5, "z"), Edit(0, 3, "y")])
    'x b z'
    """
    result, done = "", 0
    for edit in sorted(dict.fromkeys(edits), key=lambda each: (each.start, each.end)):
        if edit.start >= done:
            result += source[done : edit.start] + edit.text
            done = edit.end
    return result + source[done:]


def _bounds(span: Span, source: str) -> tuple[int, int] | None:
    """Return the positions of a span on one line, or None if it has several; a span without an end is empty."""
    if span.end_line not in (None, span.line):
        return None
    begins = [0, *(found.end() for found in _LINE_BREAK.finditer(source))]
    if not 1 <= span.line <= len(begins):
        return None
    start = begins[span.line - 1] + span.column - 1
    end = start if span.end_column is None else begins[span.line - 1] + span.end_column - 1
    line_end = begins[span.line] if span.line < len(begins) else len(source)
    return (start, end) if start <= end <= line_end else None


def _renamed(written: str, fix: Fix, is_yaml: bool) -> str | None:
    """Return another name in the necessary quotes, or None if the old one is not in the text."""
    quotes = (
        written[:1] if written[:1] in _QUOTES and written[-1:] == written[:1] and len(written) > 1 else ""
    )
    if (written[1:-1] if quotes else written) != fix.replaces:
        return None
    if not is_yaml:
        return f"{quotes}{fix.replacement}{quotes}"
    return quoted(fix.replacement) if quotes else word(fix.replacement)
