"""Hover for a key or fixed word of the language: its description."""

from __future__ import annotations

from composer.lsp.answers import Hover
from composer.lsp.language import doc_of, words_of
from composer.lsp.question import Question


def show(question: Question) -> Hover | None:
    """Return the description of the key or word at the cursor, or None."""
    cursor = question.cursor
    if cursor.role != "value" and cursor.whole:
        text = doc_of((*cursor.path, cursor.whole), question.data)
        return Hover(f"**`{cursor.whole}`**\n\n{text}", question.word) if text else None
    text = words_of(question.forms).get(cursor.whole.strip(), "")
    text = text or (
        doc_of(cursor.path, question.data) if cursor.path and isinstance(cursor.path[-1], str) else ""
    )
    return Hover(f"**`{cursor.whole.strip()}`**\n\n{text}", question.word) if text else None
