"""Find references: the places in the recipe and the models that use a name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from composer.diagnostics.span import Span
from composer.lsp.analysis import Analysis
from composer.lsp.names import Known
from composer.lsp.parameters import parameter_at, parameter_uses
from composer.lsp.places import PART, part_called
from composer.lsp.question import Question
from composer.lsp.subject import declared_at, in_model, named_at, part_named_at
from composer.lsp.uses import Use, uses_in
from composer.tree.name_index import NameIndex

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


def references(question: Question, declaration: bool = True) -> list[Span]:
    """Return the places that use what is at the cursor. With `declaration`, its declaration comes first."""
    analysis = question.analysis
    found: list[Span] = []
    for known in named_at(question):
        meant = in_model(known, analysis)
        found += declared_at(meant, analysis) if declaration else ()
        found += uses_of(meant, analysis)
    if (at := part_named_at(question)) is not None:
        found += _now([use.span for use in uses_of_part(part_called(at, analysis.plan), analysis)], analysis)
    if (parameter := parameter_at(question)) is not None and parameter[1] is None:
        found += _now(parameter_uses(parameter[0], analysis.tree), analysis)
    return list(dict.fromkeys(found))


def _now(spans: Iterable[Span], analysis: Analysis) -> Iterator[Span]:
    """Yield places of the tree at their positions in the current text."""
    for span in spans:
        if (now := analysis.now(span, analysis.tree_of)) is not None:
            yield now


def uses_of(known: Known, analysis: Analysis) -> Iterator[Span]:
    """Yield the places that refer to an element, in the recipe and in the composed model."""
    for use in uses_in(analysis.tree):
        if use.text == name_there(known, use, analysis) and known.namespace in use.wanted.namespaces:
            yield from _now([use.span], analysis)
    traced = analysis.traced
    if traced is None:
        return
    for node, attribute in NameIndex.of(traced.model.root).users(known.namespace, known.name):
        if (span := _written(node, attribute, analysis)) is not None:
            yield span


def _written(node: Node, attribute: str, analysis: Analysis) -> Span | None:
    traced = analysis.traced
    if traced is None or node not in traced.watch.lives:
        return None
    span = traced.written_at(node, attribute)
    return None if span is None else analysis.now(span, analysis.model_of)


def name_there(known: Known, use: Use, analysis: Analysis) -> str | None:
    """Return the name of an element at a place that uses it: the final name, or the name inside its part."""
    if not use.wanted.of:
        return known.name
    prefix = analysis.names.prefixes.get(part_called(use.wanted.of, analysis.plan))
    if prefix is None or not known.name.startswith(prefix):
        return None
    return known.name[len(prefix) :]


def uses_of_part(part: str, analysis: Analysis) -> Iterator[Use]:
    """Yield the places that name a part, or anything in it by its prefix."""
    prefix = analysis.names.prefixes.get(part)
    for use in uses_in(analysis.tree):
        if use.wanted.of:
            continue
        is_part = PART in use.wanted.namespaces
        if (is_part and (use.text == part or use.text.startswith(f"{part}/"))) or (
            prefix and not is_part and use.text.startswith(prefix)
        ):
            yield use
