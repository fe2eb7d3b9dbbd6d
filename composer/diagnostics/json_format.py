"""Diagnostics as JSON lines, for programs."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span


def render(diagnostic: Diagnostic) -> str:
    """One JSON object on one line, ASCII only, with the same keys for every diagnostic.

    >>> render(Diagnostic("bad-name", "no"))
    '{"severity": "error", "code": "bad-name", "message": "no", "span": null, "notes": [], "help": null, "cells": []}'
    """
    return json.dumps(
        {
            "severity": diagnostic.severity.value,
            "code": diagnostic.code,
            "message": diagnostic.message,
            "span": _span(diagnostic.span),
            "notes": [{"message": note.message, "span": _span(note.span)} for note in diagnostic.notes],
            "help": diagnostic.help,
            "cells": [asdict(cell) for cell in diagnostic.cells],
        }
    )


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
