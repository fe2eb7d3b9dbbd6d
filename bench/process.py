"""The whole command from a cold start, against an interpreter that only imports what we stand on."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

from bench.models import RECIPE, REPOSITORY
from bench.row import Row
from bench.timing import Candidate, best_times

_IMPORTS = "import lxml.etree, pydantic, yaml, numpy, click"
_TO_IMPORTS = 2.0


def rows() -> list[Row]:
    build = ["-m", "composer", "build", str(RECIPE), "-o", str(Path("bench.zip").absolute()), "--no-verify"]
    candidates: dict[str, Candidate] = {
        "imports": lambda: _run("-c", _IMPORTS),
        "build": lambda: _run(*build),
        "help": lambda: _run("-m", "composer", "--help"),
    }
    best = best_times(candidates, rounds=20, seconds=20, clock=_processor_time)
    whole = best["build"] / best["imports"]
    return [
        Row("whole build, --no-verify / bare imports", whole, _TO_IMPORTS, RECIPE.name),
        Row("--help / bare imports", best["help"] / best["imports"], None),
    ]


def _processor_time() -> float:
    """Of all processes that have been run: other work on the machine adds less to it than to the time on the wall."""
    if sys.platform == "win32":
        return time.perf_counter()
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _run(*arguments: str) -> None:
    """Compiled modules are kept beside the benchmark: every round but the first finds them."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(Path("compiled").absolute())}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, *arguments]
    subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, capture_output=True)
