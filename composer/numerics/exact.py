"""Exponential and logarithm with the same bits on every machine, unlike those of the C library."""

from __future__ import annotations

import math
from decimal import Context, Decimal

# Results are rounded correctly to 40 digits, and then to a double.
_DIGITS = Context(prec=40, Emin=-999_999, Emax=999_999)


def exp(x: float) -> float:
    """Return e to the power of x; infinity if that is too large.

    >>> exp(1.0)
    2.718281828459045
    """
    if x > 1000:  # far beyond what a double or this context can hold
        return math.inf
    return float(Decimal(x).exp(_DIGITS))


def log(x: float) -> float:
    """Return the natural logarithm of a positive number.

    >>> log(10.0)
    2.302585092994046
    """
    return float(Decimal(x).ln(_DIGITS))
