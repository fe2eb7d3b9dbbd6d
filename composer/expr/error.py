"""Errors in expressions, with their position in the text."""

from __future__ import annotations


class ExpressionError(Exception):
    """An error at characters `start` to `end` of the parsed text; `help` says how to fix it."""

    def __init__(self, message: str, start: int, end: int, help: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.start = start
        self.end = end
        self.help = help

    def moved(self, by: int) -> ExpressionError:
        """Return the same error for a text in which the expression is `by` characters later."""
        return ExpressionError(self.message, self.start + by, self.end + by, self.help)


class UnknownName(ExpressionError):
    """A name that the scope does not have; code that knows the existing names can say more."""

    def __init__(self, name: str, start: int, end: int) -> None:
        super().__init__(f"`{name}` does not exist", start, end)
        self.name = name

    def moved(self, by: int) -> UnknownName:
        return UnknownName(self.name, self.start + by, self.end + by)
