"""Pictures of several models side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from composer.pictures.png import png

_GAP = 6
_PAPER = 255


def sheet(mujoco: Any, asked: Mapping[str, Any]) -> None:
    """Write the PNG ``out`` from the arrays in the files ``tiles``; runs under `composer.engine.call`."""
    tiles = [np.load(each) for each in asked["tiles"]]
    height, width, _ = tiles[0].shape
    columns = columns_of(len(tiles), width / height)
    rows = math.ceil(len(tiles) / columns)
    paper = np.full((rows * (height + _GAP) + _GAP, columns * (width + _GAP) + _GAP, 3), _PAPER, np.uint8)
    for number, tile in enumerate(tiles):
        row, column = divmod(number, columns)
        top, left = _GAP + row * (height + _GAP), _GAP + column * (width + _GAP)
        paper[top : top + height, left : left + width] = tile
    Path(asked["out"]).write_bytes(png(paper))


def columns_of(count: int, aspect: float) -> int:
    """Return the number of tiles in a row, so that the sheet is about as wide as high, or a little wider.

    >>> [columns_of(count, 4 / 3) for count in (1, 2, 6, 16, 100)]
    [1, 2, 3, 4, 11]
    """
    return max(1, min(count, round(math.sqrt(count * 1.6 / aspect))))
