"""Parse numbers as MuJoCo does in XML.

It accepts anything that C's `strtod` does: a sign, decimals, exponents, hexadecimals, `inf`, `nan`. Integers are
decimal digits only and fit in 32 bits. Items are separated by ASCII white space; a comma is never a separator.
"""

from __future__ import annotations

import math
import re

REAL = re.compile(
    r"[+-]?(?:0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[+-]?[0-9]+)?"
    r"|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?"
    r"|inf(?:inity)?|nan(?:\([0-9a-z_]*\))?)",
    re.IGNORECASE | re.ASCII,
)
INTEGER = re.compile(r"[+-]?[0-9]+", re.ASCII)
SPACE = " \t\n\r\f\v"
INT_MIN, INT_MAX = -(2**31), 2**31 - 1


def items(text: str) -> list[str]:
    """Split a list at ASCII white space only; a no-break space separates nothing."""
    return re.split(f"[{SPACE}]+", text.strip(SPACE)) if text.strip(SPACE) else []


def parse_real(text: str) -> float | None:
    """Return the number for a single item, or `None` if MuJoCo would refuse it, also for overflow.

    >>> parse_real("1e-3"), parse_real("0x1p3"), parse_real("1,5"), parse_real("1e400")
    (0.001, 8.0, None, None)
    """
    if REAL.fullmatch(text) is None:
        return None
    lower = text.lower()
    if "nan" in lower:
        return math.nan
    if "0x" in lower:
        try:
            return float.fromhex(text)
        except OverflowError:
            return None
    value = float(text)
    if math.isinf(value) and "inf" not in lower:
        return None
    return value


def parse_int(text: str) -> int | None:
    """Return the integer for a single item, or `None` if MuJoCo would refuse it.

    >>> parse_int("010"), parse_int("1.0"), parse_int("2147483648")
    (10, None, None)
    """
    if INTEGER.fullmatch(text) is None:
        return None
    value = int(text)
    return value if INT_MIN <= value <= INT_MAX else None
