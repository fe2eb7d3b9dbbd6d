"""URDF: MuJoCo reads the same robot; what ROS needs is there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from lxml import etree
from targets.models import SELDOM
from targets.writing import written

from composer.bundle.folder import write_folder
from composer.targets.judging import faults, poses

SETTINGS = '<mujoco><compiler fusestatic="false" discardvisual="false" strippath="false"/></mujoco></robot>'
MASS = ('<mass value="0"/>', '<mass value="1e-12"/>')
"""MuJoCo has no massless links that move."""


def test_mujoco_reads_the_same_robot(tmp_path: Path) -> None:
    bundle, context = written(SELDOM, "urdf", tmp_path)
    assert bundle is not None and not context.sink.has_errors
    write_folder(bundle, tmp_path / "seldom")
    urdf = (tmp_path / "seldom" / "model.urdf").read_text().replace("</robot>", SETTINGS).replace(*MASS)
    urdf = urdf.replace(
        'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"',
        'ixx="1e-12" ixy="0" ixz="0" iyy="1e-12" iyz="0" izz="1e-12"',
    )
    truth = mujoco.MjModel.from_xml_string(SELDOM)
    read = mujoco.MjModel.from_xml_string(urdf)
    asked = poses(truth)
    assert list(faults(mujoco, truth, _facts(read, asked), asked, single=False)) == []


def _facts(model: mujoco.MjModel, asked: list[dict[str, Any]]) -> dict[str, Any]:
    data = mujoco.MjData(model)
    found: dict[str, Any] = {"bodies": {}, "joints": {}, "poses": []}
    for number in range(1, model.nbody):
        turned = np.zeros(9)
        mujoco.mju_quat2Mat(turned, model.body_iquat[number])
        axes = turned.reshape(3, 3)
        found["bodies"][model.body(number).name] = {
            "mass": model.body_mass[number],
            "com": model.body_ipos[number],
            "inertia": axes @ np.diag(model.body_inertia[number]) @ axes.T,
        }
    for number in range(model.njnt):
        limited = bool(model.jnt_limited[number])
        found["joints"][model.joint(number).name] = {"range": model.jnt_range[number] if limited else None}
    for pose in asked:
        for name, value in pose["joints"].items():
            data.joint(name).qpos[:] = value
        mujoco.mj_kinematics(model, data)
        found["poses"].append(
            {
                model.body(n).name: [data.xpos[n].copy(), data.xmat[n].reshape(3, 3).copy()]
                for n in range(1, model.nbody)
            }
        )
    return found


def test_what_ros_needs(tmp_path: Path) -> None:
    bundle, _ = written(
        SELDOM.replace("<exclude", '<exclude body1="pad" body2="finger_1"/><exclude'), "urdf", tmp_path
    )
    assert bundle is not None
    robot = etree.fromstring(bundle.files["model.urdf"])
    limit = robot.find("joint[@name='turn']/limit")
    assert limit is not None and limit.get("effort") == "30" and limit.get("velocity") == "1000000"
    mimic = robot.find("joint[@name='bend_0']/mimic")
    assert mimic is not None and dict(mimic.attrib) == {
        "joint": "bend_1",
        "multiplier": "0.5",
        "offset": "0.1",
    }
    control = robot.find("ros2_control")
    assert control is not None
    assert {
        each.get("name"): each.find("command_interface").get("name") for each in control.iterfind("joint")
    } == {  # type: ignore[union-attr]
        "turn": "position",
        "slide": "effort",
    }
    srdf = etree.fromstring(bundle.files["model.srdf"])
    apart = [
        (each.get("link1"), each.get("link2"), each.get("reason"))
        for each in srdf.iterfind("disable_collisions")
    ]
    assert ("pad", "finger_1", "Excluded in MuJoCo") in apart and ("stand", "two_joints", "Adjacent") in apart
    state = srdf.find("group_state[@name='home']")
    assert state is not None and [each.get("name") for each in state] == [
        "turn",
        "slide",
        "spin",
        "bend_0",
        "bend_1",
    ]
    assert b"<name>recipe</name>" in bundle.files["package.xml"]
