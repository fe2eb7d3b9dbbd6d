"""The inertia of a body in a form that stays possible: its second moments of mass, stretched and sheared.

A triangular factor with a positive diagonal turns second moments into those of another possible body (Rucker and
Wensing, IEEE RA-L 2022). So every list of six numbers is a possible inertia.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from mjcompose.base.rotation import Quat, rotate

Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def reshaped(moments: Sequence[float], quat: Quat, shape: Sequence[float]) -> Matrix:
    """Return the inertia in the frame of the body, from principal moments and their frame.

    `shape` has the logarithms of the stretches along the axes of the body, then the shears of x by y, of y by z, and of
    x by z. Zeros change nothing.

    >>> reshaped([1, 2, 2.5], (1, 0, 0, 0), [0, 0, 0, 0, 0, 0])
    ((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.5))
    >>> twice_as_long = reshaped([1, 1, 1], (1, 0, 0, 0), [math.log(2), 0, 0, 0, 0, 0])
    >>> [round(row[axis], 6) for axis, row in enumerate(twice_as_long)]
    [1.0, 2.5, 2.5]
    """
    x, y, z, xy, yz, xz = shape
    factor: Matrix = ((math.exp(x), xy, xz), (0.0, math.exp(y), yz), (0.0, 0.0, math.exp(z)))
    half = sum(moments) / 2
    turned = _transposed([rotate(quat, axis) for axis in _AXES])
    principal = _matrix([[(half - moments[row]) * (row == column) for column in range(3)] for row in range(3)])
    second = _product(_product(turned, principal), _transposed(turned))
    second = _product(_product(factor, second), _transposed(factor))
    trace = second[0][0] + second[1][1] + second[2][2]
    return _matrix([[trace * (row == column) - second[row][column] for column in range(3)] for row in range(3)])


def _matrix(rows: Sequence[Sequence[float]]) -> Matrix:
    first, second, third = (tuple(row) for row in rows)
    return (first, second, third)  # type: ignore[return-value]


def _transposed(rows: Sequence[Sequence[float]]) -> Matrix:
    return _matrix([[rows[row][column] for row in range(3)] for column in range(3)])


def _product(left: Matrix, right: Matrix) -> Matrix:
    return _matrix(
        [
            [sum(left[row][index] * right[index][column] for index in range(3)) for column in range(3)]
            for row in range(3)
        ]
    )
