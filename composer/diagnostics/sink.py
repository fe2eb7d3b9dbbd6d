"""Where every stage puts its diagnostics, so that one run reports all of them."""

from __future__ import annotations

from collections.abc import Iterable

from composer.diagnostics.codes import CODES
from composer.diagnostics.diagnostic import Diagnostic, Note, Severity
from composer.diagnostics.span import Span


class Sink:
    """Collects diagnostics in the order they are found; the same diagnostic twice is kept once.

    A code that `CODES` does not declare is a bug of the caller and raises `KeyError`.
    """

    def __init__(self) -> None:
        # A dict keeps the order of insertion and finds repetitions in constant time.
        self._found: dict[Diagnostic, None] = {}
        self._errors: list[Diagnostic] = []

    def add(self, diagnostic: Diagnostic) -> None:
        if diagnostic.code not in CODES:
            raise KeyError(diagnostic.code)
        if diagnostic not in self._found:
            self._found[diagnostic] = None
            if diagnostic.severity is Severity.ERROR:
                self._errors.append(diagnostic)

    def error(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        *,
        notes: Iterable[Note] = (),
        help: str | None = None,
    ) -> None:
        self.add(Diagnostic(code, message, span, Severity.ERROR, tuple(notes), help))

    def warning(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        *,
        notes: Iterable[Note] = (),
        help: str | None = None,
    ) -> None:
        self.add(Diagnostic(code, message, span, Severity.WARNING, tuple(notes), help))

    def note(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        *,
        notes: Iterable[Note] = (),
        help: str | None = None,
    ) -> None:
        self.add(Diagnostic(code, message, span, Severity.NOTE, tuple(notes), help))

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """All diagnostics, in the order they were added."""
        return list(self._found)

    def sorted(self) -> list[Diagnostic]:
        """All diagnostics by file, line and column; those without a place come last, in their order."""
        return sorted(self._found, key=_place)

    @property
    def errors(self) -> list[Diagnostic]:
        """The diagnostics that stop the work, in the order they were added."""
        return list(self._errors)

    @property
    def has_errors(self) -> bool:
        return bool(self._errors)


def _place(diagnostic: Diagnostic) -> tuple[bool, str, int, int]:
    span = diagnostic.span
    return (True, "", 0, 0) if span is None else (False, span.file, span.line, span.column)
