"""The input of providers: a place in a recipe about which an editor asks."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.document.node import Node, find, to_python
from composer.lsp.analysis import Analysis
from composer.lsp.cursor import Cursor, Path, cursor_at
from composer.lsp.language import Form, forms_at
from composer.lsp.repaired import repaired


@dataclass(frozen=True)
class Question:
    """A place in a recipe. `lines` are those of the newest text; everything else is in the `analysis`.

    `line` and `column` are counted from 0.
    """

    analysis: Analysis
    lines: list[str]
    line: int
    column: int

    @cached_property
    def cursor(self) -> Cursor:
        return cursor_at(self.lines, self.line, self.column)

    @cached_property
    def tree(self) -> Node | None:
        """Return the tree of the text with the cursor, or None."""
        return repaired(self.lines, self.cursor, self.analysis.tree)

    @cached_property
    def data(self) -> Any:
        return None if self.tree is None else to_python(self.tree)

    @cached_property
    def forms(self) -> list[Form]:
        """Return what the language allows at the path of the cursor."""
        return forms_at(self.cursor.path, self.data)

    @property
    def path(self) -> Path:
        return self.cursor.path

    def at(self, path: Path) -> Any:
        """Return the data at a path of the text with the cursor, or None."""
        found = None if self.tree is None else find(self.tree, path)
        return None if found is None else to_python(found)

    @property
    def word(self) -> Span:
        """Return the word at the cursor."""
        cursor = self.cursor
        return Span(self.analysis.file, cursor.line + 1, cursor.start + 1, cursor.line + 1, cursor.end + 1)
