from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import pytest
from mjcompose.base.access import ALL
from mjcompose.mujoco.convert import Converted, convert_urdf
from mjcompose.mujoco.engine import RequestLimits, Session

INERTIAL = '<inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>'
ARM = f"""<robot name="arm">
  <link name="base">{INERTIAL}</link>
  <link name="upper">{INERTIAL}<collision><geometry><mesh filename="package://arm/wedge.obj"/></geometry></collision></link>
  <link name="tool">{INERTIAL}</link>
  <joint name="turn" type="continuous">
    <origin xyz="0.1 0 0" rpy="0.3 0 0"/><parent link="base"/><child link="upper"/>
  </joint>
  <joint name="end" type="fixed"><origin xyz="0 0 1"/><parent link="upper"/><child link="tool"/></joint>
</robot>"""
WEDGE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"

fuses = pytest.mark.skipif(not hasattr(mujoco.MjSpec, "fuse_static"), reason="this MuJoCo fuses without a trace")


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    (tmp_path / "wedge.obj").write_text(WEDGE)
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    return path


def convert(path: Path, packages: dict[str, Path], limits: RequestLimits | None = None, **options: Any) -> Converted:
    with Session(limits) as session:
        return convert_urdf(path, packages, door=ALL, session=session, **options)


def converted(path: Path, *, is_fixed: bool = True) -> ElementTree.Element:
    result = convert(path, {"arm": path.parent}, is_fixed=is_fixed)
    assert result.text is not None, result.error
    return ElementTree.fromstring(result.text)


def test_numbers_have_all_their_digits(arm: Path) -> None:
    (mesh,) = converted(arm).iter("mesh")
    upper = next(body for body in converted(arm).iter("body") if body.get("name") == "upper")
    spec = mujoco.MjSpec.from_file(str(arm))
    assert [float(x) for x in str(upper.get("quat")).split()] == spec.body("upper").quat.tolist()
    assert mesh.get("file") == (arm.parent / "wedge.obj").as_posix()


@fuses
def test_what_is_fused_leaves_a_frame_with_a_mark(arm: Path) -> None:
    root = converted(arm)
    assert [body.get("name") for body in root.iter("body")] == ["upper"]
    held = {frame.get("name"): holder for holder in root.iter() for frame in holder.findall("frame[@name]")}
    assert held.keys() == {"base", "upper", "tool"}
    assert held["tool"].get("pos") == "0 0 1" and held["upper"].tag == "body"


@fuses
def test_the_root_stays_a_body_where_it_does_not_stand_in_the_world(arm: Path) -> None:
    root = converted(arm, is_fixed=False)
    assert [body.get("name") for body in root.iter("body")] == ["base", "upper"]
    base = root.find("worldbody/body/inertial")
    assert base is not None and base.get("mass") == "1"


def test_a_package_that_is_not_known(arm: Path) -> None:
    result = convert(arm, {"other": arm.parent})
    assert (result.text, result.crash, result.meshes) == (None, None, ("package://arm/wedge.obj",))
    assert result.error is not None


def test_a_mesh_that_is_not_there(arm: Path) -> None:
    text = ARM.replace("<robot name", "<robot  name").replace("package://arm/wedge.obj", "meshes/no.obj")
    arm.write_text(text.replace("<link", '<mujoco><compiler meshdir="m"/></mujoco><link', 1))
    result = convert(arm, {})
    assert (result.text, result.meshes, result.folder.rstrip("/")) == (None, ("meshes/no.obj",), "m")


def test_warnings_of_reading_come_once(arm: Path) -> None:
    arm.write_text(ARM.replace('<parent link="base"/>', '<parent link="base"/><mimic joint="no"/>'))
    result = convert(arm, {"arm": arm.parent})
    assert result.text is not None
    if hasattr(mujoco.MjSpec, "fuse_static"):  # an older one has no mimic
        assert len(result.warnings) == 1 and "turn" in result.warnings[0]


def test_what_mujoco_refuses(arm: Path) -> None:
    arm.write_text(ARM.replace('child link="upper"', 'child link="no"'))
    result = convert(arm, {})
    assert result.text is None and result.error is not None and "joint" in result.error


def test_no_verdict(arm: Path) -> None:
    result = convert(arm, {}, limits=RequestLimits(seconds=1e-6))
    assert (result.text, result.crash) == (None, "timeout")
