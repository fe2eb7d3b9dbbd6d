"""The programs that read models, each in an environment of its own below `build/consumers`.

`python environments.py [NAME …]` makes those that are missing. What cannot be had is told, and its tests are skipped.
"""

from __future__ import annotations

import subprocess
import sys
import venv
from pathlib import Path

from mjcompose.targets.read_back import READERS

FOLDER = Path(__file__).parents[2] / "build" / "consumers"
PACKAGES = {reader.program: reader.packages for reader in READERS.values()}
"""By the name of the program. Isaac Sim needs a GPU, and is not tested."""

ROBOTS = {"robots": ("example-robot-data",)}
"""No program, but the URDFs that tests/urdf reads."""


def python_of(name: str) -> Path:
    """The interpreter of an environment."""
    inside = "Scripts/python.exe" if sys.platform == "win32" else "bin/python"
    return FOLDER / name / inside


def is_ready(name: str) -> bool:
    return (FOLDER / name / ".ready").is_file()


def make(name: str) -> str | None:
    """Install what a reader needs; the reason where that fails."""
    venv.create(FOLDER / name, with_pip=True, clear=True)
    install = [str(python_of(name)), "-m", "pip", "install", "--quiet", *{**PACKAGES, **ROBOTS}[name]]
    done = subprocess.run(install, capture_output=True, text=True, check=False)
    if done.returncode:
        return next(iter(reversed(done.stderr.strip().splitlines())), "pip failed")
    (FOLDER / name / ".ready").touch()
    return None


if __name__ == "__main__":
    for wanted in sys.argv[1:] or (*PACKAGES, *ROBOTS):
        reason = None if is_ready(wanted) else make(wanted)
        if reason is not None:
            print(f"{wanted}: {reason}")
