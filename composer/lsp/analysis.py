"""What an analysis found in one recipe: in its current text, or in the last text that could be read."""

from __future__ import annotations

from collections.abc import Mapping as Entries
from dataclasses import field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node
from composer.lsp.lines import lines_of, moved
from composer.lsp.names import Names, names_of
from composer.plan.plan import Plan

if TYPE_CHECKING:
    from lxml.etree import _Element

    from composer.compose.load import Library
    from composer.explain.traced import Traced
    from composer.tree.unit import Unit


@dataclass(frozen=True, eq=False, slots=True)
class Model:
    """A composed model: its tree, the part of each element, and all that it was composed from.

    `library` has the sources as they were read then, and `texts` what editors had not saved then.
    """

    unit: Unit
    plan: Plan
    parts: Entries[_Element, str]
    library: Library
    texts: Entries[str, bytes]


@dataclass(frozen=True)
class Analysis:
    """The result of analysing a recipe. It never changes.

    `tree`, `plan` and `model` are those of the current text, or of the last text that had one; `is_current` and
    `is_composed` say which. `tree_of`, `plan_of` and `model_of` are the texts in which they were found. `found` has
    the diagnostics, `files` all files that were read, and `library` the sources as they were read.

    `traced` says where the elements of the model come from. To find out takes as long as the rest, and no diagnostic
    needs it: it is None until `Workspace.traced` is asked.
    """

    path: Path
    folder: Path
    text: str
    tree: Node | None = None
    plan: Plan | None = None
    model: Model | None = None
    traced: Traced | None = None
    is_current: bool = False
    is_composed: bool = False
    found: tuple[Diagnostic, ...] = ()
    files: frozenset[Path] = frozenset()
    library: Library = field(default_factory=dict)
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

    @cached_property
    def names(self) -> Names:
        """Return the names in the model, and those of parts that it lacks."""
        if self.plan is None:
            return Names()
        model = self.model
        root, composed = (None, None) if model is None else (model.unit.root, model.plan)
        return names_of(self.plan, root, composed, self.library)

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
