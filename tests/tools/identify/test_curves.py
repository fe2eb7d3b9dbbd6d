"""The rows of a curve."""

from __future__ import annotations

import numpy as np
from mjcompose.tools.identify.curves import _telling_rows
from mjcompose.tools.identify.problem import RecordingPiece
from mjcompose.tools.identify.recording import Recording, Signal


def piece(count: int, rows: slice) -> RecordingPiece:
    recording = Recording("run.csv", "", np.arange(count) * 0.01, {Signal("qpos", "elbow"): np.zeros(count)}, {})
    return RecordingPiece(recording, 0.0, rows, np.zeros(3), (), 10)


def test_a_long_recording_is_thinned_and_keeps_its_peaks() -> None:
    whole = piece(100_000, slice(0, 100_000))
    recipe = np.zeros(100_000)
    fitted = np.zeros(100_000)
    recipe[12_345] = -1.0
    fitted[67_891] = 0.1
    fitted[80_001] = np.nan
    rows = _telling_rows(whole.recording, whole, {"recipe": recipe, "fitted": fitted})
    assert len(rows) < 350
    assert {0, 12_345, 67_891, 80_001, 99_999} <= set(rows.tolist())
    assert (np.diff(rows) > 0).all()


def test_a_short_recording_keeps_all_rows() -> None:
    short = piece(200, slice(50, 150))
    errors = {"recipe": np.zeros(100), "fitted": np.zeros(100)}
    rows = _telling_rows(short.recording, short, errors)
    assert rows.tolist() == list(range(100))
