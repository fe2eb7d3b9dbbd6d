"""Find the line of the caller's program that made an element."""

from __future__ import annotations

import sys

from composer.diagnostics.span import Span

_ROOM = __name__.rpartition(".")[0]


def call_site() -> Span:
    """Return the innermost line of the call stack outside this package."""
    frame = sys._getframe(1)
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).startswith(_ROOM):
        frame = frame.f_back
    return Span(frame.f_code.co_filename, frame.f_lineno, 1)
