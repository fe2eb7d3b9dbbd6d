"""Physics without the files that only show."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.film import png
from mjcompose.mujoco.playable import strip

SPIKE = "v 0 0 0.3\nv 0.2 0 0\nv -0.1 0.1 0\nv -0.1 -0.1 0\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n" + "# long\n" * 200
MODEL = """<mujoco>
  <asset>
    <texture name="t" type="2d" file="t.png"/><material name="t" texture="t"/>
    <mesh file="shown.obj"/><mesh file="heavy.obj" scale="1 2 1"/><mesh file="solid.obj"/>
  </asset>
  <default><default class="shown"><geom contype="0" conaffinity="0" type="mesh"/></default></default>
  <worldbody>
    <body name="arm" pos="0 0 1"><joint axis="0 1 0"/>
      <geom class="shown" mesh="shown" mass="0" material="t"/><geom size="0.1" pos="0.3 0 0"/>
      <body name="&lt;odd&gt;" pos="0.5 0 0"><joint axis="1 0 0"/><geom name="heavy" class="shown" mesh="heavy"/></body>
    </body>
    <body name="free" pos="1 0 1"><freejoint/><geom type="mesh" mesh="solid"/></body>
  </worldbody>
  <sensor>{}</sensor>
</mujoco>
"""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    (tmp_path / "in").mkdir()
    for name in ("shown", "heavy", "solid"):
        (tmp_path / "in" / f"{name}.obj").write_text(SPIKE)
    (tmp_path / "in" / "t.png").write_bytes(png(np.zeros((64, 64, 3), np.uint8)))
    (tmp_path / "in" / "model.xml").write_text(MODEL.format(""))
    return tmp_path


def stripped(folder: Path) -> Path:
    return Path(strip(mujoco, {"model": str(folder / "in" / "model.xml"), "out": str(folder / "out")}))


def after(path: Path) -> Any:
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for _ in range(200):
        mujoco.mj_step(model, data)
    return data.qpos


def test_files_that_only_show_are_tiny_and_nothing_moves_otherwise(model: Path) -> None:
    out = stripped(model)
    sizes = {each.name: each.stat().st_size for each in out.parent.iterdir()}
    assert sizes["shown.obj"] < 100 and sizes["heavy.obj"] < 100 and sizes["t.png"] < 200
    assert sizes["solid.obj"] == len(SPIKE), "its geom collides"
    assert "<inertial" in out.read_text() and "<inertial" not in (model / "in" / "model.xml").read_text()
    assert (model / "in" / "shown.obj").read_text() == SPIKE
    np.testing.assert_allclose(after(out), after(model / "in" / "model.xml"), atol=1e-9)


def test_a_mesh_stays_if_the_mass_cannot_be_written(model: Path) -> None:
    text = MODEL.format("").replace("<asset>", '<compiler inertiafromgeom="true"/><asset>')
    (model / "in" / "model.xml").write_text(text)
    out = stripped(model)
    assert (out.parent / "heavy.obj").read_text() == SPIKE and (out.parent / "shown.obj").read_text() != SPIKE
    np.testing.assert_allclose(after(out), after(model / "in" / "model.xml"), atol=1e-9)


@pytest.mark.parametrize(
    "sensor", ['<framepos objtype="geom" objname="heavy"/>', '<distance geom1="heavy" body2="free" cutoff="1"/>']
)
def test_all_files_stay_if_a_sensor_looks_at_geoms(model: Path, sensor: str) -> None:
    (model / "in" / "model.xml").write_text(MODEL.format(sensor))
    assert stripped(model) == model / "in" / "model.xml"
