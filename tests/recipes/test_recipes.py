"""The example recipes build, and what they build stands still."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.bundle.write import write
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from sampling import need_robots, rest_slow

ROOT = Path(__file__).resolve().parents[2]
RECIPES = sorted((ROOT / "recipes").glob("*.yaml"))
# What is told of them on purpose.
TOLD = {"soft_arm": ["convert-loss"]}
NEEDS_MORE = {f"menagerie_{name}" for name in ("bimanual", "collision", "go1_z1", "panda_allegro", "so101")}
"""Recipes of robots that only the corpus has."""
QUICK = {path.stem for path in RECIPES} - NEEDS_MORE - {"menagerie_cell", "menagerie_randomised", "held_payload"}


@pytest.mark.parametrize("path", rest_slow(RECIPES, QUICK, lambda path: path.stem))
def test_builds_and_moves_without_a_warning(path: Path, tmp_path: Path, menagerie_root: Path) -> None:
    if path.stem == "xacro_arm":
        pytest.importorskip("xacro")
    if path.stem in NEEDS_MORE and not os.environ.get("MJCOMPOSE_CORPUS"):
        pytest.skip("MJCOMPOSE_CORPUS names no corpus")
    need_robots(path, menagerie_root)
    context = Context(environment={**os.environ, "MENAGERIE_ROOT": str(menagerie_root)})
    built = build(ModelRequest(path), context)
    assert built is not None
    assert [each.code for each in context.sink.diagnostics] == TOLD.get(path.stem, [])
    write(built.bundle, f"{tmp_path}/out/", environment={})
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml"))
    data = mujoco.MjData(model)
    while data.time < 0.2:
        mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)
    assert np.isfinite(data.qpos).all()
