"""Diagnostics as JSON lines, for programs."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.span import Span


def render(diagnostic: Diagnostic) -> str:
    """Return one JSON object on one line, ASCII only, with the same keys for every diagnostic.

    >>> render(Diagnostic("bad-name", "no"))[:68]
    '{"severity": "error", "code": "bad-name", "message": "no", "span": n'
    """
    return json.dumps(
        {
            "severity": diagnostic.severity.value,
            "code": diagnostic.code,
            "message": diagnostic.message,
            "span": _span(diagnostic.span),
            "notes": [_note(note) for note in diagnostic.notes],
            "help": diagnostic.help,
            "fix": _fix(diagnostic),
            "others": [_note(each) for each in diagnostic.others],
            "cells": [asdict(cell) for cell in diagnostic.cells],
            "recipes": list(diagnostic.recipes),
        }
    )


def _note(note: Note) -> dict[str, Any]:
    return {"message": note.message, "span": _span(note.span)}


def _fix(diagnostic: Diagnostic) -> dict[str, Any] | None:
    """Return a fix as replacement text for a span.

    A fix of a name gets its quotes once its file is known: see `composer.fixing.edit.exact`.
    """
    fix = diagnostic.fix
    if fix is None or fix.replaces is not None:
        return None
    return {"replacement": fix.replacement, "span": _span(fix.span or diagnostic.span)}


def _span(span: Span | None) -> dict[str, Any] | None:
    if span is None:
        return None
    return {
        "file": span.file,
        "line": span.line,
        "column": span.column,
        "end_line": span.end_line,
        "end_column": span.end_column,
    }
