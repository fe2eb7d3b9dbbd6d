"""The start of an expression. Separate from the rest of the room, which only recipes with expressions need."""

from __future__ import annotations

OPENING = "${"


def is_template(text: str) -> bool:
    """Return whether the text contains an expression."""
    return OPENING in text
