"""Compositions as users make them of whole robots: built, written, and each part asked of the bundle once more."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from click.testing import CliRunner
from mjcompose.cli.main import main

FOLDER = os.environ.get("MJCOMPOSE_CORPUS")

ARM = """
recipe: 1
base: menagerie:universal_robots_ur5e/ur5e
attach:
  hand: {model: menagerie:wonik_allegro/left_hand, site: attachment_site}
conflict: mujoco
"""
NESTED = """
recipe: 1
attach:
  left: {model: ./arm.yaml, pos: [0, 0.5, 0]}
  right: {model: ./arm.yaml, pos: [0, -0.5, 0]}
conflict: mujoco
"""
COPIES = """
recipe: 1
attach:
  panda: {model: menagerie:franka_emika_panda/panda, replicate: [{count: 4, offset: [0, 1, 0]}]}
conflict: mujoco
"""
HANDS = """
recipe: 1
base: menagerie:unitree_g1/g1
attach:
  left: {model: menagerie:wonik_allegro/left_hand, body: left_wrist_yaw_link, pos: [0.1, 0, 0]}
  right: {model: menagerie:robotiq_2f85/2f85, body: right_wrist_yaw_link, pos: [0.1, 0, 0]}
conflict: mujoco
"""


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER, reason="MJCOMPOSE_CORPUS names no corpus")
@pytest.mark.parametrize(
    ("recipe", "members"), [(NESTED, 4), (COPIES, 4), (HANDS, 3)], ids=["nested", "copies", "hands"]
)
def test_a_bundle_of_robots_is_unchanged(
    recipe: str, members: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MENAGERIE_ROOT", f"{FOLDER}/models")
    Path("arm.yaml").write_text(ARM)
    Path("cell.yaml").write_text(recipe)
    built = CliRunner().invoke(main, ["build", "cell.yaml", "-o", "out/"])
    assert built.exit_code == 0, built.output
    verified = CliRunner().invoke(main, ["verify", "out"])
    assert verified.exit_code == 0, verified.output
    assert f"{members} of {members} parts compared with their sources and unchanged" in verified.output
