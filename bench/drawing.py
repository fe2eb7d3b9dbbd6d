"""A number of a table of draws, against the one SHA-256 that its bits are made of."""

from __future__ import annotations

import hashlib
import time

from mjcompose.language.distribution import FieldDistribution

from bench.row import Row
from bench.timing import best_times

_SAMPLES = range(1, 5001)
_TO_HASHES = 15.0
_DRAWN = (
    FieldDistribution("uniform", {"min": (0.4,), "max": (1.2,)}),
    FieldDistribution("normal", {"mean": (0.0,), "std": (0.02,)}),
    FieldDistribution("truncnormal", {"mean": (1.0,), "std": (0.2,), "min": (0.5,), "max": (2.0,)}),
    FieldDistribution("loguniform", {"min": (0.5,), "max": (2.0,)}),
)


def rows() -> list[Row]:
    best = best_times(
        {
            "draws": lambda: [each.draw_all(7, _SAMPLES, "field", "cube/box", 0, 0) for each in _DRAWN],
            "hashes": lambda: [
                hashlib.sha256(b'["mjcompose draws 1",7,%d,"field","cube/box",0]' % each).digest() for each in _SAMPLES
            ],
        },
        rounds=5,
        seconds=5,
        clock=time.process_time,
    )
    one = best["draws"] / len(_DRAWN)
    note = f"{one / len(_SAMPLES) * 1e6:.1f} us; uniform, normal, truncnormal and loguniform alike"
    return [Row("a number of a table of draws / one SHA-256", one / best["hashes"], _TO_HASHES, note)]
