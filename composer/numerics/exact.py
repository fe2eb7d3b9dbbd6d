"""Exponential and logarithm to the same bits on every machine, which those of the C library are not."""

from __future__ import annotations

from decimal import Context, Decimal

# Results are rounded correctly to 40 digits, and then to a double.
_DIGITS = Context(prec=40, Emin=-999_999, Emax=999_999)


def exp(x: float) -> float:
    """E to the power of x; infinity where that is too large.

    >>> exp(1.0)
    2.718281828459045
    """
    return float(Decimal(x).exp(_DIGITS))


def log(x: float) -> float:
    """The natural logarithm of a positive number.

    >>> log(10.0)
    2.302585092994046
    """
    return float(Decimal(x).ln(_DIGITS))
