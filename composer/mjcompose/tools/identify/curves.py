"""Recorded and simulated motion, for pictures. Runs in MuJoCo's process."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from mjcompose.tools.identify.problem import Problem, RecordingPiece
from mjcompose.tools.identify.recording import Recording, Signal
from mjcompose.tools.identify.tables import Series

_MOST = 320
"""The most rows of a curve."""


def curves_of(problem: Problem, errors: Mapping[str, Sequence[Series]]) -> list[dict[str, Any]]:
    """Return for each recording and signal the rows of a picture, in pieces that each begin at the recorded place.

    `errors` has prediction minus recording for each piece: of the `recipe` and of the `fitted` model.
    """
    curves = []
    for recording in problem.recordings:
        numbers = [number for number, piece in enumerate(problem.pieces) if piece.recording is recording]
        for column, signal in enumerate(recording.signals):
            parts = [
                _part(problem.pieces[number], {word: each[number][:, column] for word, each in errors.items()}, signal)
                for number in numbers
            ]
            curves.append(
                {
                    "file": recording.file,
                    "signal": signal.word,
                    "unit": _unit(problem, signal),
                    "seconds": recording.seconds,
                    "parts": parts,
                }
            )
    return curves


def _part(piece: RecordingPiece, errors: Mapping[str, Series], signal: Signal) -> dict[str, list[float | None]]:
    recording = piece.recording
    rows = _telling_rows(recording, piece, errors)
    recorded = recording.signals[signal][piece.rows]
    part = {"times": _plain(recording.times[piece.rows][rows]), "recorded": _plain(recorded[rows])}
    return part | {word: _plain((recorded + error)[rows]) for word, error in errors.items()}


def _telling_rows(recording: Recording, piece: RecordingPiece, errors: Mapping[str, Series]) -> Series:
    """Return few rows of a piece: its ends, and between them those with the largest errors."""
    count = piece.rows.stop - piece.rows.start
    most = max(8, _MOST * count // len(recording.times))
    if count <= most:
        return np.arange(count)
    edges = np.linspace(0, count, most // len(errors) + 1).astype(int)
    rows = {0, count - 1}
    for error in errors.values():
        size = np.abs(np.nan_to_num(error, nan=np.inf))
        rows |= {int(begin + size[begin:end].argmax()) for begin, end in pairwise(edges)}
    return np.array(sorted(rows))


def _plain(values: Series) -> list[float | None]:
    """Return numbers for JSON: a robot that falls over may have none."""
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]


def _unit(problem: Problem, signal: Signal) -> str:
    """Return the unit of a signal, or nothing for a sensor, which may have any."""
    if signal.kind == "sensor":
        return ""
    is_hinge = problem.model.joint(signal.name).type[0] == problem.mujoco.mjtJoint.mjJNT_HINGE
    unit = "rad" if is_hinge else "m"
    return unit if signal.kind == "qpos" else f"{unit}/s"
