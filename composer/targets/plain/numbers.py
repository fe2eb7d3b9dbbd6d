"""Numbers as text that reads back to the same bits."""

from __future__ import annotations

from typing import Any

import numpy as np


def text(values: Any) -> str:
    """The shortest digits of one number or of several, of the precision that they have.

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
