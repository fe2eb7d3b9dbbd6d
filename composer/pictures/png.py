"""Write pictures as PNG files."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COLOUR_TYPES = {3: 2, 4: 6}
_UP = 2


def png(picture: NDArray[Any]) -> bytes:
    """Return the PNG of an array of bytes, RGB `(height, width, 3)` or with opacity `(height, width, 4)`."""
    height, width, channels = picture.shape
    rows = np.zeros((height, 1 + channels * width), np.uint8)  # each row begins with its filter
    flat = picture.reshape(height, -1)
    rows[:, 1:] = flat
    rows[1:, 0], rows[1:, 1:] = _UP, flat[1:] - flat[:-1]
    header = struct.pack(">2I5B", width, height, 8, _COLOUR_TYPES[channels], 0, 0, 0)
    return (
        _SIGNATURE
        + _chunk(b"IHDR", header)
        + _chunk(b"IDAT", zlib.compress(rows.tobytes(), 9))
        + _chunk(b"IEND", b"")
    )


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
