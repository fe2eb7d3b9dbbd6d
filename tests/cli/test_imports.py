"""What is asked for little costs little: heavy libraries are imported where they are used, not before."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("mujoco", "numpy", "pydantic")
_TELL = """
import atexit, sys
atexit.register(lambda: print("imported:", *(name for name in {heavy!r} if name in sys.modules), file=sys.stderr))
sys.argv = ["mjcompose", *{arguments!r}]
from composer.cli.main import main
main()
"""


def imported(*arguments: str) -> set[str]:
    """The heavy libraries that the command imports."""
    program = _TELL.format(heavy=(*HEAVY, "composer"), arguments=arguments)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    told = done.stderr.rsplit("imported:", 1)[1].split()
    assert "composer" in told
    return set(told) - {"composer"}


@pytest.mark.parametrize("arguments", [("--help",), ("--version",), ("build", "--help")])
def test_help_imports_nothing_heavy(arguments: tuple[str, ...]) -> None:
    assert imported(*arguments) == set()


def test_a_plan_needs_pydantic_alone(repository: Path) -> None:
    assert imported("plan", str(repository / "recipes" / "arm_gripper.yaml")) == {"pydantic"}
