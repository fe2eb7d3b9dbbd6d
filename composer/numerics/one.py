"""The arithmetic of distributions for single numbers; `many.py` has it for arrays, with the same bits."""

from __future__ import annotations

from composer.numerics.exact import exp
from composer.numerics.normal import quantile
from composer.numerics.stream import below, fraction

__all__ = ["below", "exp", "fraction", "quantile", "within"]


def within(value: float, low: float, high: float) -> float:
    """Limit a value to the bounds, which rounding might exceed."""
    return min(max(value, low), high)
