"""Numbers as text from which the same bits are read back."""

from __future__ import annotations

from typing import Any

import numpy as np


def text(values: Any) -> str:
    """Return one or several numbers with the fewest digits that their precision needs.

    >>> text([0.1, 2.0]), text(np.float32(0.1))
    ('0.1 2', '0.1')
    """
    return " ".join(_one(value) for value in np.ravel(values))


def _one(value: Any) -> str:
    if isinstance(value, np.integer):
        return str(int(value))
    if isinstance(value, np.bool_):
        return "true" if value else "false"
    if value == 0:
        return "0"
    plain = 1e-5 <= abs(value) < 1e16
    write = np.format_float_positional if plain else np.format_float_scientific
    return write(value, trim="-", unique=True)
