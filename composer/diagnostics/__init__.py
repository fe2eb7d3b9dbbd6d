"""Diagnostics as data, the sink that collects them, and one renderer for each format."""

from __future__ import annotations

from composer.diagnostics.codes import CODES
from composer.diagnostics.diagnostic import Cause, Diagnostic, Note, Severity
from composer.diagnostics.failure import MjcomposeError
from composer.diagnostics.github import render as render_github
from composer.diagnostics.json_format import render as render_json
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import closest, exists_note
from composer.diagnostics.text import render, summary

__all__ = [
    "CODES",
    "Cause",
    "Diagnostic",
    "MjcomposeError",
    "Note",
    "Severity",
    "Sink",
    "Span",
    "closest",
    "exists_note",
    "render",
    "render_github",
    "render_json",
    "summary",
]
