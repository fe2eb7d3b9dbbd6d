"""The values of expressions: booleans, whole and real numbers, text, and vectors of numbers."""

from __future__ import annotations

Value = bool | int | float | str | tuple["Value", ...]

MAX_INTEGER = 2**63


def kind(value: Value) -> str:
    """Return the noun in messages for a value's type.

    >>> kind(True), kind(2), kind(2.0), kind("x"), kind((1, 2))
    ('a boolean', 'a number', 'a number', 'text', 'a vector')
    """
    if isinstance(value, bool):
        return "a boolean"
    if isinstance(value, (int, float)):
        return "a number"
    return "text" if isinstance(value, str) else "a vector"


def shown(value: Value) -> str:
    """Return a value as text: the shortest one that reads back as the same number.

    >>> shown(0.1), shown(2.0), shown(2), shown(True), shown((1, 0.5)), shown("left")
    ('0.1', '2.0', '2', 'true', '[1, 0.5]', 'left')
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "[" + ", ".join(shown(each) for each in value) + "]"
    return value if isinstance(value, str) else repr(value)
