"""An exception that carries a diagnostic, for code without a sink that does not know the place."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.span import Span


class DiagnosticError(Exception):
    """An error in the input that the caller reports; `code` is one of `CODES`.

    >>> error = DiagnosticError("bad-name", "no", notes=["why"])
    >>> str(error), error.at(Span("a.yaml", 1, 2)).span
    ('no', Span(file='a.yaml', line=1, column=2, end_line=None, end_column=None))
    """

    def __init__(
        self, code: str, message: str, help: str | None = None, *, notes: Iterable[str | Note] = ()
    ) -> None:
        super().__init__(message)
        self.diagnostic = Diagnostic(
            code,
            message,
            notes=tuple(Note(each) if isinstance(each, str) else each for each in notes),
            help=help,
        )

    @property
    def code(self) -> str:
        return self.diagnostic.code

    @property
    def message(self) -> str:
        return self.diagnostic.message

    @property
    def help(self) -> str | None:
        return self.diagnostic.help

    @property
    def notes(self) -> tuple[str, ...]:
        """The messages of the notes."""
        return tuple(note.message for note in self.diagnostic.notes)

    def at(self, span: Span, notes: Iterable[Note] = ()) -> Diagnostic:
        """Return the diagnostic at the caller's place, with the caller's notes after its own."""
        return replace(self.diagnostic, span=span, notes=(*self.diagnostic.notes, *notes))
