"""The error for worlds that cannot be loaded, joined or converted."""

from __future__ import annotations

from collections.abc import Sequence

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.loading.errors import LoadError


def failure(code: str, message: str, help: str | None = None, notes: Sequence[str] = ()) -> LoadError:
    """Return an exception with one diagnostic."""
    return LoadError([Diagnostic(code, message, notes=tuple(map(Note, notes)), help=help)])
