"""What is asked for little costs little: heavy libraries are imported where they are used, not before."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("mujoco", "numpy", "pydantic")
UNKNOWN_ONLY = (
    "lxml",
    "yaml",
    "importlib.metadata",
    "concurrent.futures",
    "tarfile",
    "tempfile",
    "mjcompose.sources.git_repository",
    "mjcompose.sources.web_archive",
)
"""What only a model that must be built has a use for."""
_TELL = """
import atexit, sys
atexit.register(lambda: print("imported:", *(name for name in {heavy!r} if name in sys.modules), file=sys.stderr))
sys.argv = ["mjcompose", *{arguments!r}]
from mjcompose.cli.main import main
main()
"""


def imported(*arguments: str) -> set[str]:
    """What the command imports of the heavy libraries and of what a known model does not need."""
    program = _TELL.format(heavy=(*HEAVY, *UNKNOWN_ONLY, "mjcompose"), arguments=arguments)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    told = done.stderr.rsplit("imported:", 1)[1].split()
    assert "mjcompose" in told
    return set(told) - {"mjcompose"}


@pytest.mark.parametrize("arguments", [("--help",), ("--version",), ("build", "--help")])
def test_help_imports_nothing_heavy(arguments: tuple[str, ...]) -> None:
    assert imported(*arguments) == set()


def test_a_plan_needs_no_mujoco_and_no_numpy(repository: Path) -> None:
    assert imported("plan", str(repository / "recipes" / "arm_gripper.yaml")).intersection(HEAVY) == {"pydantic"}


def test_a_known_model_needs_nothing_that_reads_or_builds_one(repository: Path, tmp_path: Path) -> None:
    recipe = repository / "recipes" / "arm_gripper.yaml"
    build = ("build", str(recipe), "-o", str(tmp_path / "model.zip"), "--no-compile")
    assert "lxml" in imported(*build)
    assert imported(*build) == set()
