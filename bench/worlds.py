"""Worlds: what they take to compute and on disk for each number that is drawn, and to hand to MuJoCo's batch."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

from bench.models import REPOSITORY
from bench.row import Row
from bench.timing import best_times

_HANDED = 2000
_RECIPE = REPOSITORY / "recipes" / "held_payload.yaml"
_BYTES = 200.0
_SECONDS = 0.3


def rows() -> list[Row]:
    from mjcompose import worlds

    command = ["build", str(_RECIPE), "--as", "worlds", "--no-cache", "-o", "worlds/", "-q"]
    subprocess.run([sys.executable, "-m", "mjcompose", *command], check=True)
    study = worlds.load("worlds/")
    columns = json.loads(Path("worlds/randomize.json").read_text())["columns"]
    size = Path("worlds/worlds.npz").stat().st_size / (study.count * len(columns))
    note = f"a limit in itself: {study.count} worlds of {_RECIPE.name}"
    found = [Row("bytes of worlds.npz for a drawn number", size, _BYTES, note)]
    if find_spec("mujoco.batch") is None:
        return found  # before MuJoCo 3.17
    few = study.take(range(_HANDED))
    best = best_times({"batch": lambda: worlds.mujoco(few, nthread=1)}, rounds=5, seconds=5, clock=time.process_time)
    return [*found, Row(f"seconds to hand {_HANDED} of them to mujoco.batch", best["batch"], _SECONDS, note)]
