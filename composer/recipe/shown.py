"""Values in messages."""

from __future__ import annotations

from composer.grammar.format import number_text


def shown(value: object) -> str:
    """Return a value as YAML on one line.

    >>> shown([0, "90deg", 1.5])
    '[0, 90deg, 1.5]'
    """
    if isinstance(value, list | tuple):
        return f"[{', '.join(shown(item) for item in value)}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return number_text(value) if isinstance(value, int | float) else str(value)


def kind_of(value: object) -> str:
    """Return the kind of a value, with the value itself if it is short: `text `abc``, `a list`."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if value is None:
        return "nothing"
    kind = "text" if isinstance(value, str) else "a boolean" if isinstance(value, bool) else "a number"
    text = shown(value)
    if isinstance(value, float) and text.removeprefix("-").isdigit():
        text += ".0"  # what is expected may be a whole number, which this is not
    return f"{kind} `{text}`" if len(text) <= 40 and "\n" not in text else kind
