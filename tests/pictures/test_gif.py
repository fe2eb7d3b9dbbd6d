"""GIFs, read back by another program."""

from __future__ import annotations

import io

import numpy as np
import pytest

from composer.pictures.gif import gif

image = pytest.importorskip("PIL.Image")


def _read(data: bytes) -> list[np.ndarray]:
    file = image.open(io.BytesIO(data))
    found = []
    for number in range(file.n_frames):
        file.seek(number)
        found.append(np.array(file.convert("RGB")).astype(int))
    return found


def test_few_colours_stay_as_they_are() -> None:
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
