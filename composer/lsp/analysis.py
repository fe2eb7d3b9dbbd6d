"""What an analysis found in one recipe: in its current text, or in the last text that could be read."""

from __future__ import annotations

from dataclasses import field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node
from composer.lsp.lines import lines_of, moved
from composer.lsp.names import Names
from composer.plan.plan import Plan

if TYPE_CHECKING:
    from composer.explain.traced import Traced


@dataclass(frozen=True)
class Analysis:
    """The result of analysing a recipe. It never changes.

    `tree`, `plan` and `traced` are those of the current text, or of the last text that had one; `is_current` and
    `is_composed` say which. `tree_of`, `plan_of` and `model_of` are the texts in which they were found. `found` has
    the diagnostics, `files` all files that were read, and `names` the names in the model. `composed` is the plan
    from which `traced` was composed.
    """

    path: Path
    folder: Path
    text: str
    tree: Node | None = None
    plan: Plan | None = None
    traced: Traced | None = None
    composed: Plan | None = None
    is_current: bool = False
    is_composed: bool = False
    found: tuple[Diagnostic, ...] = ()
    files: frozenset[Path] = frozenset()
    names: Names = field(default_factory=Names)
    tree_of: str = ""
    plan_of: str = ""
    model_of: str = ""

    @cached_property
    def lines(self) -> list[str]:
        return lines_of(self.text)

    @cached_property
    def file(self) -> str:
        """Return the path of the recipe as spans write it."""
        return shown(self.path, self.folder)

    @property
    def mapping(self) -> Mapping | None:
        return self.tree if isinstance(self.tree, Mapping) else None

    @property
    def separator(self) -> str:
        return self.plan.separator if self.plan is not None else "/"

    def now(self, span: Span, of: str) -> Span | None:
        """Return the current place of something in an earlier text, or None if it may have changed since."""
        if span.file != self.file or of == self.text:
            return span
        lines = moved(lines_of(of), self.lines)
        line, end = lines.get(span.line - 1), None if span.end_line is None else lines.get(span.end_line - 1)
        if line is None or (span.end_line is not None and end is None):
            return None
        return replace(span, line=line + 1, end_line=None if end is None else end + 1)


def shown(path: Path, folder: Path) -> str:
    """Return a path as spans write it in a context with this folder."""
    from composer.context import Context

    return Context(folder=folder, environment={}).shown(path)
