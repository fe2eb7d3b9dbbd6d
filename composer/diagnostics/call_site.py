"""Find the line of the caller's program that called this package."""

from __future__ import annotations

import sys

from composer.diagnostics.span import Span


def call_site(package: str = "composer.mjcf") -> Span:
    """Return the innermost line of the call stack outside of a package."""
    inside, frame = f"{package}.", sys._getframe(1)
    while frame.f_back is not None and f"{frame.f_globals.get('__name__', '')}.".startswith(inside):
        frame = frame.f_back
    return Span(frame.f_code.co_filename, frame.f_lineno, 1)
