"""The error for a model reference that cannot be resolved, before its place is known."""

from __future__ import annotations

from composer.diagnostics.error import DiagnosticError


class SourceError(DiagnosticError):
    """A fault in a model reference; the notes say what exists, `help` what to write instead."""
