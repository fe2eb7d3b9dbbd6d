"""Many small models: what a cluster costs for each, and whether memory grows with their number."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

from bench.row import Row
from bench.timing import processor_time

_FEW = 200
_MANY = 1400
_ALL = 10_000
_MILLISECONDS = 5.0
_GROWTH = 1.25
_MODEL = '<mujoco><worldbody><body name="b"><freejoint/><geom name="g" size="0.1"/></body></worldbody></mujoco>'
_RECIPE = """\
recipe: 1
name: ball
base: ./small.xml
randomize:
  seed: 7
  samples: {samples}
  fields: {{friction: {{select: {{geom: g}}, attr: friction, uniform: [0.5, 1]}}}}
"""


def rows() -> list[Row]:
    cost = "processor time of a cluster's part, ms a model"
    growth = f"memory at {_ALL} models / at {_ALL // 10}"
    if find_spec("distributed") is None:
        why = "`distributed` is not installed"
        return [Row(cost, None, _MILLISECONDS, why), Row(growth, None, _GROWTH, why)]
    Path("small.xml").write_text(_MODEL)
    alone, cluster = (
        (_cost(_MANY, *words) - _cost(_FEW, *words)) / (_MANY - _FEW) * 1000
        for words in (("--jobs", "2"), ("--jobs", "2", "--cluster", "local"))
    )
    note = f"{alone:.1f} ms with --jobs 2, {cluster:.1f} ms with --cluster local"
    rows = [Row(cost, max(cluster - alone, 0.0), _MILLISECONDS, note)]
    if not Path("/proc/self/status").exists():
        return [*rows, Row(growth, None, _GROWTH, "measured on Linux only")]
    before, after, took = _memory()
    note = f"{before:.0f} MiB and {after:.0f} MiB of all processes, 4 local workers, {took:.0f} s"
    return [*rows, Row(growth, after / before, _GROWTH, note)]


def _command(models: int, *words: str) -> list[str]:
    Path("small.yaml").write_text(_RECIPE.format(samples=models - 1))
    given = [
        "build",
        "small.yaml",
        "--all",
        "--no-cache",
        "-q",
        "-o",
        f"{'-'.join(words)}-{models}/{{hash}}/{{name}}.zip",
    ]
    return [sys.executable, "-m", "mjcompose", *given, *words]


def _cost(models: int, *words: str) -> float:
    """Seconds of processor time."""
    start = processor_time()
    subprocess.run(_command(models, *words), check=True)
    return processor_time() - start


def _memory() -> tuple[float, float, float]:
    """MiB when a tenth of the models is there, and the most at the end; and how many seconds it took."""
    start = time.monotonic()
    sizes: list[tuple[int, float]] = []
    with subprocess.Popen(_command(_ALL, "--jobs", "4", "--cluster", "local")) as process:
        while process.poll() is None:
            time.sleep(2)
            count = sum(1 for _ in Path(f"--jobs-4---cluster-local-{_ALL}").glob("*/*.zip"))
            sizes.append((count, _resident(process.pid)))
    if process.returncode:
        raise RuntimeError("the models could not be built")
    tenth = [size for count, size in sizes if count >= _ALL / 10]
    return tenth[0], max(tenth), time.monotonic() - start


def _resident(top: int) -> float:
    """MiB that a process and all below it have in memory."""
    parents: dict[int, int] = {}
    sizes: dict[int, int] = {}
    for folder in Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError, KeyError):
            about = dict(line.split(":", 1) for line in (folder / "status").read_text().splitlines() if ":" in line)
            parents[int(folder.name)] = int(about["PPid"])
            sizes[int(folder.name)] = int(about["VmRSS"].split()[0])

    def is_below(process: int) -> bool:
        while process > 1 and process != top:
            process = parents.get(process, 0)
        return process == top

    return sum(size for process, size in sizes.items() if is_below(process)) / 1024


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    sys.stdout.write("\n".join(map(str, rows())) + "\n")
