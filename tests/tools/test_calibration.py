"""The calibration of a Universal Robots arm: the model has the maker's kinematics, to the last digit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.calibration import import_calibration

LINKS = ("shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3")
KEYS = ("x", "y", "z", "roll", "pitch", "yaw")
RIGHT = np.pi / 2
# `default_kinematics.yaml` of ur_description.
POSES = {
    "ur5e": [
        (0, 0, 0.1625, 0, 0, 0),
        (0, 0, 0, RIGHT, 0, 0),
        (-0.425, 0, 0, 0, 0, 0),
        (-0.3922, 0, 0.1333, 0, 0, 0),
        (0, -0.0997, 0, RIGHT, 0, 0),
        (0, 0.0996, 0, RIGHT, np.pi, np.pi),
    ],
    "ur10e": [
        (0, 0, 0.1807, 0, 0, 0),
        (0, 0, 0, RIGHT, 0, 0),
        (-0.6127, 0, 0, 0, 0, 0),
        (-0.57155, 0, 0.17415, 0, 0, 0),
        (0, -0.11985, 0, RIGHT, 0, 0),
        (0, 0.11655, 0, RIGHT, np.pi, np.pi),
    ],
}


def calibrated(robot: str, size: float = 1e-3) -> dict[str, Any]:
    """Return the calibration of a robot that differs from its drawing by about a millimeter and a milliradian."""
    random = np.random.default_rng(1)
    poses = np.array(POSES[robot]) + random.normal(0, size, (6, 6))
    kinematics: dict[str, Any] = {
        link: dict(zip(KEYS, map(float, pose), strict=True)) for link, pose in zip(LINKS, poses, strict=True)
    }
    return {"kinematics": {**kinematics, "hash": "calib_12788084448423163542"}}


def matrix(pose: dict[str, float], turn: float) -> np.ndarray:
    """Return the pose of a link with its joint turned, by rotations of MuJoCo: `Rz(yaw) Ry(pitch) Rx(roll)`."""
    quat = np.array([1.0, 0, 0, 0])
    for axis, angle in (
        ((0, 0, 1), pose["yaw"]),
        ((0, 1, 0), pose["pitch"]),
        ((1, 0, 0), pose["roll"]),
        ((0, 0, 1), turn),
    ):
        rotation = np.zeros(4)
        mujoco.mju_axisAngle2Quat(rotation, np.array(axis, float), angle)
        mujoco.mju_mulQuat(quat, quat.copy(), rotation)
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, quat)
    found = np.eye(4)
    found[:3, :3] = turned.reshape(3, 3)
    found[:3, 3] = [pose["x"], pose["y"], pose["z"]]
    return found


def test_the_model_has_the_kinematics_of_the_calibration(menagerie_root: Path, tmp_path: Path) -> None:
    model = menagerie_root / "universal_robots_ur5e/ur5e.xml"
    calibration = calibrated("ur5e")
    file = tmp_path / "calibration.yaml"
    file.write_text(yaml.safe_dump(calibration))
    context = Context(folder=tmp_path)
    found = import_calibration(file, str(model), "A12", context)
    assert found is not None, context.sink.diagnostics
    assert (found.bodies, found.flange) == (6, "attachment_site")
    (tmp_path / "A12.yaml").write_text(found.text)
    (tmp_path / "arm.yaml").write_text(f"recipe: 1\nallow: [license-missing]\nbase: {model}\nmeasured: A12.yaml\n")
    built = build(ModelRequest(tmp_path / "arm.yaml"), context)
    assert built is not None, context.sink.diagnostics
    for name, content in built.bundle.files.items():
        (tmp_path / "built" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "built" / name).write_bytes(content)
    arm = mujoco.MjModel.from_xml_path(str(tmp_path / "built" / built.bundle.model))
    data = mujoco.MjData(arm)
    random = np.random.default_rng(2)
    frames = []
    for _ in range(20):
        data.qpos[:] = random.uniform(-3, 3, arm.nq)
        mujoco.mj_kinematics(arm, data)
        flange = np.eye(4)
        for link, turn in zip(LINKS, data.qpos, strict=True):
            flange = flange @ matrix(calibration["kinematics"][link], turn)
        site = np.eye(4)
        site[:3, :3] = data.site("attachment_site").xmat.reshape(3, 3)
        site[:3, 3] = data.site("attachment_site").xpos
        frames.append((site, flange))
    first_site, first = frames[0]
    # The base of the model is turned by right angles, and the site on the flange, too.
    for turn in range(4):
        base = np.eye(4)
        base[:2, :2] = np.linalg.matrix_power(np.array([[0, -1], [1, 0]]), turn)
        on_flange = np.linalg.inv(base @ first) @ first_site
        errors = [np.abs(base @ flange @ on_flange - site).max() for site, flange in frames]
        if max(errors) < 1e-9:
            assert np.abs(on_flange[:3, 3]).max() < 1e-9
            return
    pytest.fail("the flange is elsewhere")


def told(text: str, tmp_path: Path, model: str) -> list[tuple[str, str]]:
    (tmp_path / "calibration.yaml").write_text(text)
    context = Context(folder=tmp_path)
    assert import_calibration(tmp_path / "calibration.yaml", model, "A12", context) is None
    return [(error.code, error.message) for error in context.sink.errors]


ARM = '<mujoco><worldbody><body name="shoulder_link"><joint/><geom size=".1"/></body></worldbody></mujoco>'


def test_wrong_calibrations(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    model = str(tmp_path / "arm.xml")
    good = calibrated("ur5e")
    assert told(yaml.safe_dump(good), tmp_path, model)[0][0] == "unknown-name"
    assert told("- 1\n", tmp_path, model) == [("wrong-type", "`calibration.yaml` is not a calibration")]
    lacking = {"kinematics": {key: value for key, value in good["kinematics"].items() if key != "wrist_2"}}
    assert told(yaml.safe_dump(lacking), tmp_path, model) == [("missing-key", "`kinematics` lacks `wrist_2`")]
    good["kinematics"]["forearm"]["x"] = float("nan")
    assert told(yaml.safe_dump(good), tmp_path, model)
    good["kinematics"]["forearm"]["x"] = -425.0
    assert told(yaml.safe_dump(good), tmp_path, model)[0][0] == "out-of-range"
    lerobot = {"elbow_flex": {"id": 3, "drive_mode": 0, "homing_offset": 1073, "range_min": 800, "range_max": 3050}}
    assert "LeRobot, which does not say where the zeros" in told(json.dumps(lerobot), tmp_path, model)[0][1]


def test_a_model_of_another_robot(menagerie_root: Path, tmp_path: Path) -> None:
    model = menagerie_root / "universal_robots_ur5e/ur5e.xml"
    found = told(yaml.safe_dump(calibrated("ur10e")), tmp_path, str(model))
    assert [code for code, _ in found] == ["measured-format"]
    assert "it is a model of another robot" in found[0][1]
