"""What is wrong with an expression, and where in its text."""

from __future__ import annotations


class ExpressionError(Exception):
    """A fault at characters `start` to `end` of the text that was parsed; `help` is a line to act on."""

    def __init__(self, message: str, start: int, end: int, help: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.start = start
        self.end = end
        self.help = help

    def moved(self, by: int) -> ExpressionError:
        """The same fault in a text in which the expression stands `by` characters later."""
        return ExpressionError(self.message, self.start + by, self.end + by, self.help)


class UnknownName(ExpressionError):
    """A name that the scope does not have; who knows what there is can say more."""

    def __init__(self, name: str, start: int, end: int) -> None:
        super().__init__(f"`{name}` does not exist", start, end)
        self.name = name

    def moved(self, by: int) -> UnknownName:
        return UnknownName(self.name, self.start + by, self.end + by)
