"""The whole command from a cold start, against an interpreter that only imports what we stand on."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from bench.models import RECIPE, REPOSITORY
from bench.row import Row
from bench.timing import Candidate, best_times, processor_time

_IMPORTS = "import lxml.etree, pydantic, yaml, numpy, click"
_TO_IMPORTS = 2.5
_KNOWN = 0.25
"""Seconds that a build may take when nothing has changed: few enough not to be noticed."""


def rows() -> list[Row]:
    out = Path("bench.zip").absolute()
    known = ["-m", "mjcompose", "build", str(RECIPE), "-o", str(out)]
    build = [*known, "--no-compile", "--no-cache"]
    candidates: dict[str, Candidate] = {
        "imports": lambda: _run("-c", _IMPORTS),
        "build": lambda: _run(*build),
        "help": lambda: _run("-m", "mjcompose", "--help"),
        "python": lambda: _run("-c", "pass"),
        "known": lambda: _run(*known),
        "written": lambda: (out.unlink(missing_ok=True), _run(*known)),
    }
    best = best_times(candidates, rounds=20, seconds=20, clock=processor_time)
    whole = best["build"] / best["imports"]
    return [
        Row("whole build, --no-compile / bare imports", whole, _TO_IMPORTS, RECIPE.name),
        Row("--help / bare imports", best["help"] / best["imports"], None),
        *(
            Row(f"seconds to build a known model, {name}", best[which], _KNOWN, _times(best, which))
            for name, which in (("its zip there", "known"), ("its zip written", "written"))
        ),
    ]


def _times(best: dict[str, float], which: str) -> str:
    return f"a limit in itself; {best[which] / best['python']:.1f} times bare Python"


def _run(*arguments: str) -> None:
    """Compiled modules are kept beside the benchmark: every round but the first finds them."""
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(Path("compiled").absolute())}
    environment["MJCOMPOSE_CACHE"] = str(Path("store").absolute())
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, *arguments]
    subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, capture_output=True)
