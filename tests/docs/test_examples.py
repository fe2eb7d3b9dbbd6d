"""The programs of docs/examples run, and say what they are for."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
PROBE = "import mujoco; mujoco.Renderer(mujoco.MjModel.from_xml_string('<mujoco/>'), 8, 8)"


def run(name: str, *arguments: object, **environment: str) -> str:
    command = [sys.executable, str(EXAMPLES / name), *map(str, arguments)]
    known = {**os.environ, "PYTHONPATH": str(EXAMPLES.parents[1]), **environment}
    done = subprocess.run(command, capture_output=True, text=True, env=known)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_two_arms() -> None:
    told = run("two_arms.py").splitlines()
    assert told[0] == "True"
    left, right = map(float, re.findall(r"-?\d+\.\d*", told[1]))
    assert left < -1 and abs(right) < 0.1, "the left one is driven"


@pytest.mark.slow
def test_held_payload(tmp_path: Path) -> None:
    """Fewer worlds than the recipe has: what is learnt holds the arm in all of them better than the servos alone."""
    pytest.importorskip("mujoco.batch", reason="MuJoCo 3.17")
    recipe = EXAMPLES.parents[1] / "recipes" / "held_payload.yaml"
    command = [
        sys.executable,
        "-m",
        "mjcompose",
        "build",
        str(recipe),
        "--as",
        "worlds",
        "--set",
        "worlds=40",
        "-o",
        f"{tmp_path}/out/",
        "-q",
    ]
    subprocess.run(command, check=True, env={**os.environ, "PYTHONPATH": str(EXAMPLES.parents[1])})
    told = run("worlds/held_payload.py", f"{tmp_path}/out/", "--learn-in", 20).splitlines()
    before, after = (float(re.findall(r"\d+\.\d+", line)[0]) for line in (told[0], told[2]))
    assert after < before / 3 and "in 40 worlds" in told[2]


def test_creatures() -> None:
    told = run("creatures.py").splitlines()
    assert told[0] == "6 creatures, 56 servos, 92 degrees of freedom"
    assert len(re.findall(r"\d\.\d+", told[1])) == 6


@pytest.mark.slow
def test_a_picture_of_the_creatures(tmp_path: Path) -> None:
    probe = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, env={**os.environ, "MUJOCO_GL": "egl"})
    if probe.returncode != 0:
        pytest.skip("MuJoCo cannot render by EGL here")
    run("creatures.py", tmp_path / "creatures.png", MUJOCO_GL="egl")
    assert (tmp_path / "creatures.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_an_arm_with_a_hand(tmp_path: Path, menagerie_root: Path) -> None:
    told = run("arm_and_hand.py", tmp_path / "cell.zip", MENAGERIE_ROOT=str(menagerie_root))
    assert told.startswith("prefix of the hand: ur5e/robotiq_2f85/\nkeyframes: ['ur5e/home']\n")
    opened, closed = (float(re.findall(r"[\d.]+", line)[-1]) for line in told.splitlines()[2:])
    assert opened < 0.1 and closed > 0.5
    assert mujoco.MjSpec.from_zip(str(tmp_path / "cell.zip")).compile().nq == 21
