"""The types of a compiled model: what MuJoCo has, and what mypy finds with them."""

from __future__ import annotations

import runpy
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest
from mjcompose.mujoco import model_types

ROOT = Path(__file__).parents[2]

_WRONG = """\
from __future__ import annotations
from mjcompose.mujoco.model_types import Float64Row, MjData, MjModel

def total(masses: Float64Row) -> float:
    return float(masses.sum())

def right(model: MjModel, data: MjData) -> float:
    return total(model.body_mass) + float(data.qpos[0]) + model.nq

def misspelt(model: MjModel) -> float:
    return total(model.body_masses)

def wrong_axes(model: MjModel) -> float:
    return total(model.body_pos)

def state_for_model(data: MjData) -> float:
    return total(data.body_mass)
"""


def test_the_types_are_what_mujoco_has() -> None:
    text = Path(model_types.__file__).read_text(encoding="utf-8")
    if f"from MuJoCo {mujoco.__version__};" not in text:
        pytest.skip("the types are those of another MuJoCo")
    assert text == runpy.run_path(str(ROOT / ".ci" / "model_types.py"))["written"](), "`make schemas` writes it anew"


@pytest.mark.slow
def test_mypy_finds_a_misspelt_array_and_one_with_other_axes(tmp_path: Path) -> None:
    (tmp_path / "wrong.py").write_text(_WRONG)
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--follow-imports=silent", "wrong.py"]
    command.insert(-1, f"--cache-dir={tmp_path / 'cache'}")
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    errors = [
        int(line.split(":")[1])
        for line in run.stdout.splitlines()
        if line.startswith("wrong.py") and ": error: " in line
    ]
    assert errors == [11, 14, 17], run.stdout + run.stderr
