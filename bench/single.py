"""A single verified build from a cold start, against MuJoCo's own attach, compile and zip in a process of its own.

`python -m bench.single` prints where the time goes.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from pathlib import Path

from bench.models import REPOSITORY
from bench.row import Row
from bench.scratch import in_scratch_folder
from bench.timing import Candidate, best_times, processor_time

_RECIPE = REPOSITORY / "recipes" / "menagerie_ur5e_2f85.yaml"
_MODELS = ("universal_robots_ur5e/ur5e.xml", "robotiq_2f85/2f85.xml")
_LIMIT = 1.3
_EQUAL = 1.15
_MJSPEC = """
import mujoco, sys
arm, hand = map(mujoco.MjSpec.from_file, sys.argv[1:3])
for key in [*arm.keys, *hand.keys]:
    arm.delete(key) if key in arm.keys else hand.delete(key)
arm.attach(hand, prefix="gripper/", site=arm.site("attachment_site"))
model = arm.compile()
if len(sys.argv) > 3:  # what a build does, too
    import os, zipfile
    mujoco.mj_forward(model, mujoco.MjData(model))
    with zipfile.ZipFile("mjspec.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("model.xml", arm.to_xml())
        for folder in {os.path.dirname(file) for file in sys.argv[1:3]}:
            for name in sorted({mesh.file for mesh in arm.meshes}):
                if os.path.exists(file := os.path.join(folder, "assets", name)):
                    with open(file, "rb") as asset:
                        archive.writestr(name, asset.read())
else:
    arm.to_zip("mjspec.zip")
"""
_STARTS = (
    ("Python and the command's own options", "import mjcompose.cli.main, mjcompose.cli.build"),
    ("what knows the cache", "import mjcompose.pipeline.cache.builder"),
    ("what reads, plans, links and bundles", "import mjcompose.pipeline.stages, mjcompose.verify.compile"),
)


def rows() -> list[Row]:
    name = "a cold build of ur5e + 2f85 / MjSpec, "
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    folder = os.environ.get("MENAGERIE_ROOT") or (corpus and str(Path(corpus, "models")))
    if not folder:
        return [Row(f"{name}time", None, _LIMIT, "MENAGERIE_ROOT is not set")]
    candidates = _candidates(Path(folder))
    wall = best_times(candidates, rounds=10, seconds=20)
    processor = best_times(candidates, rounds=10, seconds=20, clock=processor_time)
    free = (os.cpu_count() or 1) - os.getloadavg()[0] if hasattr(os, "getloadavg") else 1
    note = f"{wall['build']:.2f} s; the zip of MjSpec has no assets"
    return [
        Row(f"{name}time", wall["build"] / wall["mjspec"], _LIMIT if free > 1 else None, note),
        Row(f"{name}processor time", processor["build"] / processor["mjspec"], None),
        Row(
            f"{name}processor time, equal content",
            processor["build"] / processor["equal"],
            _EQUAL,
            f"{processor['build']:.2f} s against {processor['equal']:.2f} s: both step, and zip the assets",
        ),
    ]


def _candidates(menagerie: Path) -> dict[str, Candidate]:
    models = [str(menagerie / model) for model in _MODELS]
    return {
        "build": lambda: _run("-m", "mjcompose", "build", str(_RECIPE), "--no-cache", "-o", "ours.zip", "-q"),
        "mjspec": lambda: _run("-c", _MJSPEC, *models),
        "equal": lambda: _run("-c", _MJSPEC, *models, "equal"),
    }


def _run(*arguments: str) -> str:
    """Compiled modules are kept beside the benchmark, as an installation has them."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(Path("compiled").absolute())}
    environment["PYTHONPATH"] = str(REPOSITORY)
    environment.setdefault("MENAGERIE_ROOT", str(Path(os.environ.get("MJCOMPOSE_CORPUS", ""), "models")))
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, *arguments]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return done.stdout + done.stderr


@in_scratch_folder()
def main() -> None:
    """Each row of its own run, the shortest of several; a row of imports has those of the rows before it."""
    lines = []
    before = 0.0
    done = "pass"
    for what, imports in _STARTS:
        done = f"{done}; {imports}"
        took = best_times({what: lambda code=done: _run("-c", code)}, rounds=8, seconds=8)[what]  # type: ignore[misc]
        lines.append((what, took - before))
        before = took
    stages: dict[str, float] = {}
    whole = float("inf")
    for _ in range(6):
        start = time.perf_counter()
        said = _run("-m", "mjcompose", "build", str(_RECIPE), "--no-cache", "-o", "ours.zip", "-v")
        whole = min(whole, time.perf_counter() - start)
        for stage, seconds in re.findall(r"^  (\w+) +([\d.]+) s$", said, re.MULTILINE):
            stages[stage] = min(stages.get(stage, whole), float(seconds))
    lines += stages.items()
    lines.append(("the whole, what overlaps counted once", whole))
    sys.stdout.write("| what | s |\n|---|---|\n" + "".join(f"| {what} | {took:.2f} |\n" for what, took in lines))


if __name__ == "__main__":
    main()
