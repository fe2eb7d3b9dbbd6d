"""From a line of a model to the recipes that use it: what becomes of its element, and what refers to it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from composer.diagnostics.span import Span
from composer.lsp.analysis import Analysis, shown
from composer.lsp.answers import Hover
from composer.lsp.hover.element import describe
from composer.lsp.names import Known
from composer.lsp.navigation.references import uses_of

_MOST = 4
"""How many elements are described that one line has become."""


def elements_at(path: Path, line: int, analysis: Analysis) -> list[Known]:
    """Return the named elements of a composed model that come from a line of a file, counted from 0."""
    traced = analysis.traced
    if traced is None:
        return []
    nodes = set(traced.on_line(shown(path, analysis.folder), line + 1))
    every = (known for names in analysis.names.known.values() for known in names.values())
    return [known for known in every if known.node in nodes]


def hover_in_model(path: Path, line: int, analyses: Iterable[Analysis]) -> Hover | None:
    """Return what the element on a line becomes in each recipe, or None."""
    found = [(known, each) for each in analyses for known in elements_at(path, line, each)]
    if not found:
        return None
    texts = [f"in `{each.file}`: {describe(known, each)}" for known, each in found[:_MOST]]
    if len(found) > _MOST:
        texts.append(f"… and {len(found) - _MOST} more")
    return Hover("\n\n---\n\n".join(texts))


def references_in_recipes(path: Path, line: int, analyses: Iterable[Analysis]) -> list[Span]:
    """Return the places in recipes and models that refer to the element on a line."""
    found = [
        span for each in analyses for known in elements_at(path, line, each) for span in uses_of(known, each)
    ]
    return list(dict.fromkeys(found))
