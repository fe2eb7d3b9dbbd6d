"""Recipes opened in MuJoCo's process, against MuJoCo's own parse and compile of the model that a build writes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from bench.models import REPOSITORY
from bench.row import Row
from bench.timing import best_times

_RECIPE = REPOSITORY / "recipes" / "menagerie_ur5e_2f85.yaml"
_STATUS = Path("/proc/self/status")
_EQUAL = 1.1
_UNCHANGED = 3.0
_GROWTH = 2.0
_ROUNDS = 15
_WARM = 400
_REBUILDS = 200


def rows() -> list[Row]:
    whole = "spec() of an unchanged ur5e + 2f85, with compile / MuJoCo's parse and compile of the built model"
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    folder = os.environ.get("MENAGERIE_ROOT") or (corpus and str(Path(corpus, "models")))
    if not folder:
        return [Row(whole, None, _EQUAL, "MENAGERIE_ROOT is not set")]
    command = [sys.executable, "-m", "bench.opening", str(_REBUILDS)]
    environment = {**os.environ, "MENAGERIE_ROOT": folder}
    done = subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True, text=True, env=environment)
    found = json.loads(done.stdout)
    ours = found["spec"]
    theirs = found["mujoco"]
    result = [
        Row(whole, ours / theirs, _EQUAL, f"{1000 * ours:.1f} ms against {1000 * theirs:.1f} ms"),
        Row("spec() after an edit, beyond MuJoCo's parse, ms", 1000 * found["rebuilt"], None),
    ]
    if "decoded" in found:
        result.append(
            Row(
                "MjSpec.from_file of an unchanged recipe, beyond MuJoCo's parse, ms",
                1000 * found["decoded"],
                _UNCHANGED,
            )
        )
    if "grown" in found:
        result.append(Row(f"{_REBUILDS} rebuilds after {_WARM}: growth of the process, MiB", found["grown"], _GROWTH))
    return result


def _resident() -> float:
    line = next(line for line in _STATUS.read_text().splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1024


def _measure(rebuilds: int) -> dict[str, float]:
    import mjcompose
    import mujoco
    from mjcompose import mujoco_plugin
    from mjcompose.tools.open.recipe import text_of

    recipe = Path("opened.yaml").absolute()
    recipe.write_text(_RECIPE.read_text(encoding="utf-8"), encoding="utf-8")

    def edit() -> None:
        os.utime(recipe)

    text = text_of(recipe)
    time.sleep(0.01)
    candidates: dict[str, Callable[[], object]] = {
        "parse": lambda: mujoco.MjSpec.from_string(text),
        "mujoco": lambda: mujoco.MjSpec.from_string(text).compile(),
        "spec": lambda: mjcompose.spec(recipe).compile(),
    }
    if mujoco.mj_version() >= 4_000_000:
        mujoco_plugin.register()
        candidates["decoded"] = lambda: mujoco.MjSpec.from_file(str(recipe))
    found = best_times(candidates, rounds=_ROUNDS, seconds=10)
    parse = found.pop("parse")
    if "decoded" in found:
        found["decoded"] -= parse
    found["rebuilt"] = best_times({"": lambda: (edit(), mjcompose.spec(recipe))}, rounds=_ROUNDS, seconds=5)[""] - parse
    if _STATUS.exists():
        for number in range(_WARM + rebuilds):
            if number == _WARM:
                before = _resident()
            edit()
            mjcompose.spec(recipe)
        found["grown"] = _resident() - before
    return found


if __name__ == "__main__":
    from bench.scratch import in_scratch_folder

    with in_scratch_folder():
        sys.stdout.write(json.dumps(_measure(int(sys.argv[1]))) + "\n")
