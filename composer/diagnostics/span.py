"""A place in a text file."""

from __future__ import annotations

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Span:
    """A stretch of characters in a file.

    Lines and columns count from 1, columns in characters (not bytes or screen cells). The end is exclusive; without
    an end the span is a single position. `file` is the path that the user can open.
    """

    file: str
    line: int
    column: int
    end_line: int | None = None
    end_column: int | None = None

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"
