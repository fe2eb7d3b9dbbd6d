"""What an action may look at: the place, and what is reported there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from composer.diagnostics.diagnostic import Diagnostic
from composer.document.node import Mapping
from composer.lsp.analysis import Analysis
from composer.lsp.question import Question


@dataclass(frozen=True)
class Offer:
    """A question about a place, with the diagnostics that are shown there."""

    question: Question
    diagnostics: tuple[Diagnostic, ...]

    @property
    def analysis(self) -> Analysis:
        return self.question.analysis

    @cached_property
    def tree(self) -> Mapping | None:
        """The tree of the recipe, where it is that of the text as it is."""
        return self.analysis.mapping if self.analysis.is_current else None
