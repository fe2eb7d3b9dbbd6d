"""A small arm and a small gripper, as different in their settings as two sources are."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf

_OF_PATHS = {"signature", "nbuffer", "paths", "npaths"}
ARM = """
<mujoco model="arm">
  <compiler angle="radian" meshdir="meshes"/>
  <default>
    <joint damping="2"/>
    <default class="visual"><geom contype="0" conaffinity="0" group="2"/></default>
  </default>
  <asset><mesh name="shell" file="shell.stl"/><material name="grey" rgba="0.5 0.5 0.5 1"/></asset>
  <worldbody>
    <light pos="0 0 3"/>
    <body name="base" pos="0 0 0.1">
      <geom name="base" type="cylinder" size="0.1 0.05"/>
      <body name="upper">
        <joint name="shoulder" axis="0 1 0" range="-1.5 1.5"/>
        <geom class="visual" type="mesh" mesh="shell" material="grey"/>
        <geom name="upper" type="capsule" size="0.04" fromto="0 0 0 0 0 0.4"/>
        <body name="fore" pos="0 0 0.4">
          <joint name="elbow_joint" axis="0 1 0" range="-2 2"/>
          <geom name="fore" type="capsule" size="0.03" fromto="0 0 0 0 0 0.3"/>
          <site name="flange" pos="0 0 0.35" quat="0.7071 0 0 0.7071"/>
          <site pos="0.1 0 0.1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <contact><exclude name="near" body1="base" body2="upper"/></contact>
  <actuator>
    <position name="shoulder" joint="shoulder" kp="50"/>
    <motor name="elbow" joint="elbow_joint"/>
  </actuator>
  <sensor><framepos name="tip" objtype="site" objname="flange"/></sensor>
  <keyframe><key name="home" qpos="0.1 0.2" ctrl="0.1 0"/></keyframe>
</mujoco>
"""

GRIPPER = """
<mujoco model="gripper">
  <compiler angle="degree"/>
  <default>
    <geom friction="0.9 0.01 0.001"/>
    <default class="finger"><joint type="slide" axis="1 0 0" range="0 0.03"/></default>
  </default>
  <asset><mesh file="shell.stl" scale="0.5 0.5 0.5"/></asset>
  <worldbody>
    <body name="palm">
      <geom name="palm" type="box" size="0.04 0.03 0.02"/>
      <geom type="mesh" mesh="shell" contype="0" conaffinity="0"/>
      <body name="left" pos="0.02 0 0.05" euler="0 0 90" childclass="finger">
        <joint name="left"/>
        <geom name="left_pad" type="box" size="0.005 0.01 0.02"/>
      </body>
      <body name="right" pos="-0.02 0 0.05" childclass="finger">
        <joint name="right" axis="-1 0 0"/>
        <geom name="right_pad" type="box" size="0.005 0.01 0.02"/>
        <site name="pinch"/>
      </body>
    </body>
  </worldbody>
  <equality><joint name="mirror" joint1="left" joint2="right"/></equality>
  <tendon>
    <fixed name="split"><joint joint="left" coef="0.5"/><joint joint="right" coef="0.5"/></fixed>
  </tendon>
  <actuator><position name="fingers" tendon="split" kp="100"/></actuator>
  <keyframe><key name="open" qpos="0.03 0.03" ctrl="0.03"/></keyframe>
</mujoco>
"""


def tetrahedron(size: float) -> bytes:
    """A mesh as a binary STL."""
    a = (0.0, 0.0, 0.0)
    b = (size, 0.0, 0.0)
    c = (0.0, size, 0.0)
    d = (0.0, 0.0, size)
    faces = [(a, c, b), (a, b, d), (b, c, d), (a, d, c)]
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *x, *y, *z, 0) for x, y, z in faces)
    return b"\0" * 80 + struct.pack("<I", len(faces)) + body


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo writes a log to the working directory."""
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The two models and their meshes, which have one name, on disk."""
    (tmp_path / "arm" / "meshes").mkdir(parents=True)
    (tmp_path / "gripper").mkdir()
    (tmp_path / "arm" / "arm.xml").write_text(ARM)
    (tmp_path / "arm" / "meshes" / "shell.stl").write_bytes(tetrahedron(0.1))
    (tmp_path / "gripper" / "gripper.xml").write_text(GRIPPER)
    (tmp_path / "gripper" / "shell.stl").write_bytes(tetrahedron(0.2))
    return tmp_path


@pytest.fixture
def arm(folder: Path) -> mjcf.RootElement:
    return mjcf.from_path(folder / "arm" / "arm.xml")


@pytest.fixture
def gripper(folder: Path) -> mjcf.RootElement:
    return mjcf.from_path(folder / "gripper" / "gripper.xml")


@pytest.fixture
def compiled() -> Callable[[mjcf.RootElement], mujoco.MjModel]:
    """What MuJoCo makes of a model as it stands."""
    return lambda root: mujoco.MjModel.from_xml_string(root.to_xml_string(), root.assets)


@pytest.fixture
def differences() -> Callable[[mujoco.MjModel, mujoco.MjModel], list[str]]:
    """The arrays and sizes of two compiled models that are not equal to the bit; where files are may differ."""

    def differ(one: mujoco.MjModel, other: mujoco.MjModel) -> list[str]:
        found = []
        for name in dir(one):
            value = None if name.startswith("_") else getattr(one, name)
            if not isinstance(value, np.ndarray | int | float) or name in _OF_PATHS or "path" in name:
                continue
            floats = isinstance(value, np.ndarray) and value.dtype.kind == "f"
            if not np.array_equal(value, getattr(other, name), equal_nan=floats):
                found.append(name)
        return found

    return differ
