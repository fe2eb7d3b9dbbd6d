"""How an expression begins. Apart from the rest of the room, which only recipes with expressions need."""

from __future__ import annotations

OPENING = "${"


def is_template(text: str) -> bool:
    """Whether there is an expression in the text."""
    return OPENING in text
