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
# What Python and the command's options cost is 5 of it.
_TO_PYTHON = 10.0


def rows() -> list[Row]:
    known = ["-m", "composer", "build", str(RECIPE), "-o", str(Path("bench.zip").absolute())]
    build = [*known, "--no-verify", "--no-cache"]
    candidates: dict[str, Candidate] = {
        "imports": lambda: _run("-c", _IMPORTS),
        "build": lambda: _run(*build),
        "help": lambda: _run("-m", "composer", "--help"),
        "python": lambda: _run("-c", "pass"),
        "known": lambda: _run(*known),
    }
    best = best_times(candidates, rounds=20, seconds=20, clock=_processor_time)
    whole = best["build"] / best["imports"]
    return [
        Row("whole build, --no-verify / bare imports", whole, _TO_IMPORTS, RECIPE.name),
        Row("--help / bare imports", best["help"] / best["imports"], None),
        Row(
            "a model that is known / bare Python",
            best["known"] / best["python"],
            _TO_PYTHON,
            _in_ms(best["known"]),
        ),
    ]


def _in_ms(seconds: float) -> str:
    return f"{seconds * 1000:.0f} ms"


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
    environment["MJCOMPOSE_CACHE"] = str(Path("store").absolute())
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, *arguments]
    subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, capture_output=True)
