"""The arithmetic of distributions for one number at a time; `many.py` has it for arrays, with the same bits."""

from __future__ import annotations

from composer.numerics.exact import exp
from composer.numerics.normal import quantile
from composer.numerics.stream import below, fraction

__all__ = ["below", "exp", "fraction", "quantile", "within"]


def within(value: float, low: float, high: float) -> float:
    """Rounding does not lead out of the bounds."""
    return min(max(value, low), high)
