"""A model reference that leads nowhere, before it is known where that reference is written."""

from __future__ import annotations


class SourceError(Exception):
    """What is wrong with a model reference; who knows where it is written makes a diagnostic of it.

    `code` is one of `composer.diagnostics.CODES`, `message` stands alone, `notes` tell what exists, `help`
    what to write instead.
    """

    def __init__(
        self, code: str, message: str, *, notes: tuple[str, ...] = (), help: str | None = None
    ) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.notes = notes
        self.help = help
