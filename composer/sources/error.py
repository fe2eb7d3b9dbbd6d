"""A model reference that leads nowhere, before it is known where that reference is written."""

from __future__ import annotations

from composer.diagnostics.error import DiagnosticError


class SourceError(DiagnosticError):
    """What is wrong with a model reference; the notes say what exists, `help` what to write instead."""
