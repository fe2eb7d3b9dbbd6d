"""Numbers that count as different: bit for bit, or if they are farther apart than a bound."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct

Array = NDArray[np.generic]


class Bound(Struct):
    """How far apart two numbers may be and still count as equal: `absolute`, plus `relative` times their size.

    The size is the larger absolute value of the two numbers, the largest in their row of both arrays, or the largest in
    both arrays. It is at least `floor`. Infinite numbers and NaN have no size, and nothing else is near them.
    """

    relative: float = 0.0
    absolute: float = 0.0
    floor: float = 1.0
    of: Literal["number", "row", "array"] = "number"

    def allows(self, expected: float, actual: float) -> bool:
        """Return whether two single numbers count as equal; NaN equals NaN."""
        if expected == actual or (math.isnan(expected) and math.isnan(actual)):
            return True
        distance = abs(expected - actual)
        size = max(abs(expected), abs(actual), self.floor)
        return math.isfinite(distance) and distance <= self.absolute + self.relative * size

    def near(
        self, expected: NDArray[np.float64], actual: NDArray[np.float64], size: NDArray[np.float64] | None = None
    ) -> NDArray[np.bool_]:
        """Return the places where two arrays of floats are near each other; `size` replaces their own size."""
        with np.errstate(invalid="ignore", over="ignore"):
            distance = np.abs(expected - actual)
        if size is None:
            size = np.maximum(np.abs(expected), np.abs(actual))
        size = np.where(np.isfinite(size), size, 0.0)
        if self.of == "array":
            size = size.max(initial=0.0)
        elif self.of == "row" and size.ndim > 1:
            size = size.max(axis=tuple(range(1, size.ndim)), keepdims=True, initial=0.0)
        allowed = self.absolute + self.relative * np.maximum(size, self.floor)
        return np.asarray(np.isfinite(distance) & (distance <= allowed), dtype=np.bool_)


EXACT = Bound()
"""Bit for bit."""


def unequal(
    expected: Array, actual: Array, bound: Bound = EXACT, size: NDArray[np.float64] | None = None
) -> NDArray[np.bool_]:
    """Return the places where two arrays of one shape differ; zeros and NaNs are equal regardless of sign.

    Without a bound, they are compared bit for bit; integers always are. `size` replaces the size of the numbers.
    """
    different = expected != actual
    if different.any() and np.issubdtype(expected.dtype, np.floating):
        a = expected.astype(np.float64)
        b = actual.astype(np.float64)
        different &= ~(np.isnan(a) & np.isnan(b))
        if bound.relative or bound.absolute:
            different &= ~bound.near(a, b, size)
    return np.asarray(different, dtype=np.bool_)


def differing_rows(different: NDArray[np.bool_]) -> list[int]:
    """Return the rows of `unequal` with a difference; a single number is row 0.

    >>> differing_rows(np.array([[False, False], [True, False]])), differing_rows(np.array(True))
    ([1], [0])
    """
    rows = np.atleast_1d(different)
    found: list[int] = np.flatnonzero(rows.any(axis=tuple(range(1, rows.ndim)))).tolist()
    return found
