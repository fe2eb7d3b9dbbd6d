from __future__ import annotations

import struct
import zlib

import numpy as np

from composer.pictures.png import png


def test_the_pixels_are_there() -> None:
    picture = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
    data = png(picture)
    chunks, at = {}, 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length]) == (zlib.crc32(kind + content),)
        chunks[kind], at = content, at + 12 + length
    assert list(chunks) == [b"IHDR", b"IDAT", b"IEND"] and chunks[b"IHDR"][:8] == struct.pack(">2I", 3, 2)
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(2, 10)
    assert rows[:, 0].tolist() == [0, 2]  # the second row is the difference from the one above
    assert (np.cumsum(rows[:, 1:], axis=0, dtype=np.uint8).reshape(2, 3, 3) == picture).all()
