"""Numbers that are drawn together from a normal distribution, the same on every machine.

All arithmetic is in single operations of IEEE 754 in a fixed order: BLAS and LAPACK differ between machines, and `sum`
differs between versions of Python.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from mjcompose.base.dataclass import Struct
from mjcompose.base.draw_stream import bits, fraction, quantile

Rows = Sequence[Sequence[float]]
"""The rows of a lower triangle."""
_LEAST_PIVOT = 1e-9
_HALVINGS = 12
_ATTEMPTS = 10_000
_STREAM = "measured"


class JointNormal(Struct):
    """A normal distribution of several numbers, restricted to the numbers between bounds.

    `words` are the identities of the numbers, and `factor` is the lower triangle whose product with its transpose is
    their correlation.
    """

    words: tuple[str, ...]
    means: tuple[float, ...]
    stds: tuple[float, ...]
    bounds: tuple[tuple[float, float], ...]
    factor: Rows

    def draw(self, seed: int, sample: int) -> tuple[float, ...] | None:
        """Return one draw of all numbers, the first attempt within the bounds; None if there is none."""
        for attempt in range(_ATTEMPTS):
            numbers = self._attempted(seed, sample, attempt)
            if numbers is not None:
                return numbers
        return None

    def _attempted(self, seed: int, sample: int, attempt: int) -> tuple[float, ...] | None:
        normals: list[float] = []
        numbers: list[float] = []
        for word, mean, std, (low, high), row in zip(
            self.words, self.means, self.stds, self.bounds, self.factor, strict=True
        ):
            normals.append(quantile(fraction(bits(seed, sample, _STREAM, element=word, component=attempt))))
            distance = 0.0
            for weight, normal in zip(row, normals, strict=True):
                distance += weight * normal
            number = mean + std * distance
            if not low <= number <= high:
                return None
            numbers.append(number)
        return tuple(numbers)


def impossible_row(correlations: Rows, error: float) -> int | None:
    """Return the first row below the diagonal that contradicts the rows before it; None for a possible correlation.

    Each number may be off by `error`.

    >>> impossible_row([[0.9], [0.9, -0.9]], 0.005), impossible_row([[0.9], [0.9, 0.62]], 0.005)
    (1, None)
    """
    size = len(correlations) + 1
    row = _factored(correlations, error * (size - 1))[1]
    return None if row is None else row - 1


def factor_of(correlations: Rows, error: float) -> Rows:
    """Return the factor of a correlation, whose rows are those below the diagonal.

    A rounded correlation may be impossible. The least share that makes it possible is taken off all numbers.

    >>> factor_of([[0.6]], 0.005)
    [[1.0], [0.6, 0.8]]
    """
    rows, wrong = _factored(correlations, 0.0)
    if wrong is None:
        return rows
    low = 0.0
    high = error * len(correlations) + 2 * _LEAST_PIVOT
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        wrong = _factored(correlations, middle)[1]
        low, high = (low, middle) if wrong is None else (middle, high)
    return _factored(correlations, high)[0]


def _factored(correlations: Rows, more: float) -> tuple[list[list[float]], int | None]:
    """Return the Cholesky factor of a correlation with `more` on its diagonal, as a share of it.

    The second value is the first row that is impossible.
    """
    rows: list[list[float]] = [[1.0]]
    for below in correlations:
        row: list[float] = []
        pivot = 1.0
        for column, correlation in enumerate(below):
            other = rows[column]
            number = correlation / (1.0 + more)
            for index in range(column):
                number -= row[index] * other[index]
            number /= other[column]
            row.append(number)
            pivot -= number * number
        if pivot < _LEAST_PIVOT:
            return rows, len(rows)
        rows.append([*row, math.sqrt(pivot)])
    return rows, None
