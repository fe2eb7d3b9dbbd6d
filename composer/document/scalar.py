"""The value of an unquoted YAML scalar, by the core schema of YAML 1.2 (its section 10.3.2)."""

from __future__ import annotations

import re

_WORDS: dict[str, bool | float | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **{sign + word: float(sign + "inf") for sign in ("", "+", "-") for word in (".inf", ".Inf", ".INF")},
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}
_DECIMAL = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o[0-7]+")
_HEXADECIMAL = re.compile(r"0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NUMERIC = frozenset("+-.0123456789")
_MAX_DIGITS = 1000


def resolve(text: str) -> bool | int | float | str | None:
    """Return the value of a plain scalar.

    Raises `OverflowError` for a number that is too large for a float.

    >>> [resolve(text) for text in ("1e-3", "010", "0x1F", "no", "12:30", "1_000", "~")]
    [0.001, 10, 31, 'no', '12:30', '1_000', None]
    """
    if text in _WORDS:
        return _WORDS[text]
    if text[0] not in _NUMERIC:
        return text
    if _DECIMAL.fullmatch(text):
        return _bounded(text, 10)
    if _FLOAT.fullmatch(text):
        number = float(text)
        if number in (float("inf"), float("-inf")):
            raise OverflowError(text)
        return number
    if _OCTAL.fullmatch(text):
        return _bounded(text[2:], 8)
    if _HEXADECIMAL.fullmatch(text):
        return _bounded(text, 16)
    return text


def _bounded(digits: str, base: int) -> int:
    if len(digits) > _MAX_DIGITS:
        raise OverflowError(digits)
    number = int(digits, base)
    float(number)  # raises if it is too large for a float
    return number
