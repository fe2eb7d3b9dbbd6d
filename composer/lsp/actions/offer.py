"""The input of code actions: a place and the diagnostics that are reported there."""

from __future__ import annotations

from functools import cached_property

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.document.node import Mapping
from composer.lsp.analysis import Analysis
from composer.lsp.question import Question


@dataclass(frozen=True)
class Offer:
    """A place in a recipe, with the diagnostics that the editor shows there."""

    question: Question
    diagnostics: tuple[Diagnostic, ...]

    @property
    def analysis(self) -> Analysis:
        return self.question.analysis

    @cached_property
    def tree(self) -> Mapping | None:
        """Return the tree of the recipe, or None if the current text has none."""
        return self.analysis.mapping if self.analysis.is_current else None
