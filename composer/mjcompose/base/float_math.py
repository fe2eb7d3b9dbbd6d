"""The arithmetic of distributions for single numbers; `array_math.py` has it for arrays, with the same bits."""

from __future__ import annotations

from mjcompose.base.draw_stream import below, exp, fraction, quantile

__all__ = ["below", "exp", "fraction", "quantile", "within"]


def within(value: float, low: float, high: float) -> float:
    """Limit a value to the bounds, which rounding might exceed."""
    return min(max(value, low), high)
