"""GIFs, read back by another program."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from mjcompose.mujoco.film import gif, png

image = pytest.importorskip("PIL.Image")


def _read(data: bytes) -> list[np.ndarray]:
    file = image.open(io.BytesIO(data))
    found = []
    for number in range(file.n_frames):
        file.seek(number)
        found.append(np.array(file.convert("RGB")).astype(int))
    return found


def test_few_colors_stay_as_they_are() -> None:
    first = np.zeros((5, 7, 3), np.uint8)
    first[2:, 3:] = 250, 120, 0
    second = np.full((5, 7, 3), 200, np.uint8)
    frames = _read(gif([first, second], 0.1))
    assert [np.abs(a - b).max() for a, b in zip(frames, (first, second), strict=True)] == [0, 0]


def test_noise_of_more_codes_than_a_table_holds_is_read_back() -> None:
    noise = [np.random.default_rng(each).integers(0, 255, (120, 160, 3)).astype(np.uint8) for each in (1, 2)]
    frames = _read(gif(noise, 0.1))
    assert len(frames) == 2
    for frame, wanted in zip(frames, noise, strict=True):
        assert np.abs(frame - wanted).mean() < 12


def test_a_film_runs_at_its_rate_and_without_end() -> None:
    file = image.open(io.BytesIO(gif([np.zeros((2, 2, 3), np.uint8)] * 2, 0.05)))
    assert file.info["duration"] == 50 and file.info["loop"] == 0


def test_the_pixels_are_there() -> None:
    picture = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
    data = png(picture)
    chunks = {}
    at = 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind = data[at + 4 : at + 8]
        content = data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length]) == (zlib.crc32(kind + content),)
        chunks[kind] = content
        at = at + 12 + length
    assert list(chunks) == [b"IHDR", b"IDAT", b"IEND"] and chunks[b"IHDR"][:8] == struct.pack(">2I", 3, 2)
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(2, 10)
    assert rows[:, 0].tolist() == [0, 2]  # the second row is the difference from the one above
    assert (np.cumsum(rows[:, 1:], axis=0, dtype=np.uint8).reshape(2, 3, 3) == picture).all()
