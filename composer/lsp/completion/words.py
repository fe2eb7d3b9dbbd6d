"""Completion of the fixed words of the language: keywords, types, `true` and `false`."""

from __future__ import annotations

from collections.abc import Iterator

from composer.lsp.answers import Item
from composer.lsp.language import words_of
from composer.lsp.question import Question


def offer(question: Question) -> Iterator[Item]:
    """Yield the words that the value at the cursor can be."""
    if question.cursor.role in ("value", "either"):
        for at, (word, doc) in enumerate(words_of(question.forms).items()):
            empty = "" if word else '""'
            yield Item(word or '""', "word", "", doc, 10 + min(at, 20), empty)
