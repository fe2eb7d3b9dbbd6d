"""What is raised where worlds cannot be loaded, joined or handed over."""

from __future__ import annotations

from collections.abc import Sequence

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.loading.errors import LoadError


def failure(code: str, message: str, help: str | None = None, notes: Sequence[str] = ()) -> LoadError:
    """One fault, to be raised."""
    return LoadError([Diagnostic(code, message, notes=tuple(map(Note, notes)), help=help)])
