"""Columns of a field by name: `pos` has `x`, `y` and `z`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

_NAMES = (
    (re.compile(r"(pos|pos0|axis|dir|anchor|inertia|com|size)$"), ("x", "y", "z")),
    (re.compile(r"quat$"), ("qw", "qx", "qy", "qz")),
    (re.compile(r"rgba$"), ("r", "g", "b", "a")),
    (re.compile(r"mat$"), ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")),
)


def names(array: str, width: int) -> tuple[str, ...]:
    """Return the names of the columns of a MuJoCo array, or an empty tuple if they have no names."""
    return next((found for ends, found in _NAMES if ends.search(array) and len(found) == width), ())


def numbered(columns: Any, known: Sequence[str]) -> Any:
    """Return an index with the column names replaced by numbers. Raises KeyError with the first unknown name.

    >>> numbered(['x', 'z'], names('geom_pos', 3)), numbered(slice(0, 2), ())
    ([0, 2], slice(0, 2, None))
    """
    if isinstance(columns, str):
        if columns not in known:
            raise KeyError(columns)
        return known.index(columns)
    if isinstance(columns, list | tuple | np.ndarray):
        return [numbered(each, known) if isinstance(each, str) else each for each in columns]
    return columns
