"""Write values in MJCF: exact on re-reading, and as short as possible."""

from __future__ import annotations

import math
from collections.abc import Iterable

from composer.grammar.attribute import Attribute


def to_text(attribute: Attribute, value: object) -> str:
    """Return the text of a value that `check_python` accepts; text is unchanged, arrays are allowed.

    >>> from composer.grammar import GRAMMAR
    >>> to_text(GRAMMAR.element("geom").attributes["size"], [0.1, 2.0, -0.0])
    '0.1 2 -0'
    """
    convert = getattr(value, "tolist", None)
    if callable(convert):
        value = convert()
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return integer_text(value) if attribute.type == "int" else number_text(value)
    if isinstance(value, Iterable):
        return " ".join(to_text(attribute, item) for item in value)
    raise TypeError(f"{attribute.name} cannot hold {type(value).__name__}")


def number_text(value: int | float) -> str:
    """Return a number that MuJoCo re-reads exactly: the shortest digits, without `.0`.

    >>> number_text(0.1 + 0.2), number_text(1e22), number_text(2.0), number_text(-0.0)
    ('0.30000000000000004', '1e+22', '2', '-0')
    """
    if isinstance(value, int):
        return str(value)
    if math.isnan(value):
        return "nan"
    text = repr(value)
    return text[:-2] if text.endswith(".0") else text


def integer_text(value: int | float) -> str:
    """Return an integer; a whole float loses its `.0`, which MuJoCo would refuse."""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return number_text(value)
