"""Completion of the names of elements inside the models."""

from __future__ import annotations

from collections.abc import Iterator

from composer.lsp.answers import Item
from composer.lsp.names import Known
from composer.lsp.places import PART, Wanted, fitting, wanted_key
from composer.lsp.question import Question
from composer.lsp.subject import wanted_as_value


def offer(question: Question) -> Iterator[Item]:
    """Yield the names that fit at the cursor. Names of the most likely kind come first."""
    cursor, analysis = question.cursor, question.analysis
    for wanted, is_key in _wanted(question):
        for at, (rank, known) in enumerate(fitting(wanted, analysis.names, analysis.plan)):
            colon = ": " if is_key and not cursor.has_colon else ""
            yield Item(known.name, "part" if known.namespace == PART else known.namespace, _detail(known), "",
                       rank + min(at, 9000) / 10000, known.name + colon if colon else "")  # fmt: skip


def _detail(known: Known) -> str:
    return "part" if known.namespace == PART else known.detail


def _wanted(question: Question) -> Iterator[tuple[Wanted, bool]]:
    cursor = question.cursor
    if cursor.role in ("key", "either") and (found := wanted_key(cursor.path)) is not None:
        yield found, True
    found = wanted_as_value(question)
    if found is not None and not found.pattern:
        yield found, False
