"""Samples built by two processes, against one: what a second process costs, and how much sooner both are done."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

from bench.models import REPOSITORY
from bench.row import Row
from bench.timing import Clock, processor_time

_SAMPLES = 200
_CPU = 1.15
_WALL = 0.54
_RECIPE = REPOSITORY / "recipes" / "randomised.yaml"


def rows() -> list[Row]:
    # Beside the models that it names.
    recipe = _RECIPE.with_name("bench-samples.yaml")
    recipe.write_text(_RECIPE.read_text().replace("samples: 8", f"samples: {_SAMPLES - 1}"))
    try:
        one, two = (_build(recipe, jobs) for jobs in (1, 2))
    finally:
        recipe.unlink()
    each = f"{one[0] / _SAMPLES * 1000:.0f} ms a verified sample, {_RECIPE.name}"
    free = (os.cpu_count() or 1) - os.getloadavg()[0]
    return [
        Row("200 samples, processor time of two processes / one", two[0] / one[0], _CPU, each),
        Row(
            "200 samples, time of two processes / one",
            two[1] / one[1],
            _WALL if free > 0 else None,
            "of two cores that nobody else uses",
        ),
    ]


def _build(recipe: Path, jobs: int) -> tuple[float, float]:
    """Seconds of processor time and on the wall."""
    clocks: tuple[Clock, ...] = (processor_time, time.perf_counter)
    before = [clock() for clock in clocks]
    command = ["build", str(recipe), "--all", "--no-cache", "--jobs", str(jobs), "-o", f"{jobs}/{{name}}/", "-q"]
    subprocess.run([sys.executable, "-m", "mjcompose", *command], check=True)
    processor, wall = (clock() - start for clock, start in zip(clocks, before, strict=True))
    return processor, wall
