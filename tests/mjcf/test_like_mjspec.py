"""The same composition by `MjSpec.attach`, where that is right."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf
from mjcompose.mujoco.arrays import ROUNDING
from mjcompose.mujoco.compare import KeyMode
from mjcompose.mujoco.unchanged import compare

_MOVED = ("key_qpos", "key_qvel", "key_mpos", "key_mquat")


def spec(path: Path) -> mujoco.MjSpec:
    """As MuJoCo reads it, compiled because keys are only carried over then."""
    read = mujoco.MjSpec.from_file(str(path))
    read.compile()
    return read


def assert_alike(model: mjcf.RootElement, base: mujoco.MjSpec, tmp_path: Path) -> None:
    mjcf.export_with_assets(model, tmp_path / "ours", conflict="base")
    ours = mujoco.MjModel.from_xml_path(str(tmp_path / "ours" / "model.xml"))
    found = compare(base.compile(), ours, keys=KeyMode.PREFIX, tolerance=ROUNDING, ignore=_MOVED)
    assert [str(each) for each in found] == []


@pytest.mark.filterwarnings("ignore")
def test_on_a_site(arm: mjcf.RootElement, gripper: mjcf.RootElement, folder: Path, tmp_path: Path) -> None:
    # MuJoCo's attach loses the folder of a second model: there both meshes are read from one.
    (folder / "gripper" / "shell.stl").write_bytes((folder / "arm" / "meshes" / "shell.stl").read_bytes())
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    base = spec(folder / "arm" / "arm.xml")
    base.attach(spec(folder / "gripper" / "gripper.xml"), prefix="gripper/", site=base.site("flange"))
    assert_alike(arm, base, tmp_path)


@pytest.mark.filterwarnings("ignore")
def test_on_a_body_with_an_offset(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, folder: Path, tmp_path: Path
) -> None:
    (folder / "gripper" / "shell.stl").write_bytes((folder / "arm" / "meshes" / "shell.stl").read_bytes())
    frame = arm.find("body", "upper").attach(gripper)  # type: ignore[union-attr]
    frame.pos = [0.1, 0.2, 0.3]
    frame.quat = [0.8, 0, 0.6, 0]
    base = spec(folder / "arm" / "arm.xml")
    place = base.body("upper").add_frame(pos=[0.1, 0.2, 0.3], quat=[0.8, 0, 0.6, 0])
    base.attach(spec(folder / "gripper" / "gripper.xml"), prefix="gripper/", frame=place)
    assert_alike(arm, base, tmp_path)


@pytest.mark.filterwarnings("ignore")
def test_a_real_arm_with_a_real_gripper(menagerie_root: Path, tmp_path: Path) -> None:
    arm_path = menagerie_root / "universal_robots_ur5e" / "ur5e.xml"
    gripper_path = menagerie_root / "robotiq_2f85" / "2f85.xml"
    arm = mjcf.from_path(arm_path)
    gripper = mjcf.from_path(gripper_path)
    gripper.model = "gripper"
    arm.find("site", "attachment_site").attach(gripper)  # type: ignore[union-attr]
    base = spec(arm_path)
    base.attach(spec(gripper_path), prefix="gripper/", site=base.site("attachment_site"))
    assert_alike(arm, base, tmp_path)
