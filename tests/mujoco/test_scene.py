"""States of a model for the page: contacts, sensors, pulls."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.scene import look, poses, pull, seen

MODEL = """<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="box" pos="0 0 0.1"><freejoint/><geom name="box" type="box" size="0.1 0.1 0.1" mass="2"/><site name="s"/></body>
    <body name="arm" pos="1 0 1"><joint name="swing" axis="0 1 0" range="-90 90"/><geom size="0.05" pos="0.3 0 0" mass="1"/></body>
  </worldbody>
  <sensor><jointpos joint="swing"/><accelerometer site="s"/></sensor>
  <keyframe><key name="up" qpos="0 0 1 1 0 0 0 0.5"/></keyframe>
</mujoco>
"""


@pytest.fixture
def model() -> Any:
    return mujoco.MjModel.from_xml_string(MODEL)


def test_a_resting_box_has_the_contact_forces_of_its_weight(model: Any) -> None:
    data = mujoco.MjData(model)
    for _ in range(500):
        mujoco.mj_step(model, data)
    state = seen(mujoco, model, data)
    assert len(state["contacts"]) == 4 and {tuple(each[:2]) for each in state["contacts"]} == {(0, 1)}
    up = sum(each[10] for each in state["contacts"])
    assert up == pytest.approx(2 * 9.81, rel=1e-3), "on the second geom, upwards"
    assert all(each[5:8] == [0, 0, 1] for each in state["contacts"])
    assert state["sensors"] == pytest.approx(data.sensordata, rel=1e-4, abs=1e-4)


def test_each_keyframe_has_its_contacts_and_sensors(model: Any) -> None:
    reference, up = poses(mujoco, model, mujoco.MjData(model))
    assert len(reference["contacts"]) == 4 and up["contacts"] == []
    assert (reference["sensors"][0], up["sensors"][0]) == (0, 0.5)


def test_a_pose_is_looked_at_without_its_keyframe(model: Any) -> None:
    found = look(mujoco, model, {"qpos": [0, 0, 1, 1, 0, 0, 0, -0.25], "ctrl": []})
    assert found["contacts"] == [] and found["sensors"][0] == -0.25
    assert look(mujoco, model, {"qpos": [1, 2], "ctrl": []})["sensors"][0] == 0, "another model's pose is not taken"


def test_a_pulled_body_comes_to_the_point(model: Any) -> None:
    model.opt.gravity[:] = 0
    data, to = mujoco.MjData(model), [0.2, 0.1, 0.8]
    for _ in range(1500):
        data.xfrc_applied[:] = 0
        pull(mujoco, model, data, {"body": 1, "at": [0.1, 0.0, 0.0], "to": to})
        mujoco.mj_step(model, data)
    at = data.xpos[1] + data.xmat[1].reshape(3, 3) @ [0.1, 0, 0]
    np.testing.assert_allclose(at, to, atol=0.01)


@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"body": 0, "at": [0, 0, 0], "to": [1, 1, 1]},
        {"body": 9, "at": [0, 0, 0], "to": [1, 1, 1]},
        {"body": 1, "at": [0]},
    ],
)
def test_a_pull_of_nothing_does_nothing(model: Any, asked: dict[str, Any]) -> None:
    data = mujoco.MjData(model)
    pull(mujoco, model, data, asked)
    assert not data.xfrc_applied.any()
