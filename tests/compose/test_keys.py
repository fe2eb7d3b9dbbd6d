"""A key that holds its pose does so in MuJoCo."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """<mujoco>
  <worldbody>
    <body name="upper"><joint name="shoulder" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0"/>
      <body name="fore" pos="0.5 0 0"><joint name="elbow" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0"/></body>
    </body>
  </worldbody>
  <actuator>{}</actuator>
</mujoco>"""
SERVOS = [
    '<position name="s" joint="shoulder" kp="200" kv="20"/>',
    '<position name="s" joint="shoulder" kp="200" kv="20" gear="-3"/>',
    '<position name="s" joint="shoulder" kp="200" kv="20" timeconst="0.1"/>',
    '<intvelocity name="s" joint="shoulder" kp="200" kv="20" actrange="-9 9"/>',
    '<general name="s" joint="shoulder" gainprm="50" biastype="affine" biasprm="7 -200 -20"/>',
]
MOTOR = '<motor name="m" joint="elbow"/>'


def built(folder: Path, actuators: str, ctrl: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    (folder / "arm.xml").write_text(ARM.format(actuators))
    (folder / "r.yaml").write_text(
        f"recipe: 1\nbase: ./arm.xml\nkeyframe:\n  up: {{qpos: {{shoulder: -40deg, elbow: 30deg}}, ctrl: {ctrl}}}\n"
    )
    context = Context(environment={}, folder=folder)
    made = build(ModelRequest(folder / "r.yaml"), context)
    assert made is not None, [each.message for each in context.sink.diagnostics]
    model = mujoco.MjModel.from_xml_string(made.bundle.files["model.xml"].decode())
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    return model, data


@pytest.mark.parametrize("servo", SERVOS)
def test_without_gravity_nothing_moves(tmp_path: Path, servo: str) -> None:
    model, data = built(tmp_path, servo, "hold")
    model.opt.gravity[:] = 0
    before = data.qpos.copy()
    for _ in range(200):
        mujoco.mj_step(model, data)
    assert np.abs(data.qpos - before).max() < 1e-9
    assert before[0] == pytest.approx(np.deg2rad(-40))


@pytest.mark.parametrize("servo", SERVOS)
def test_forces_balance_gravity(tmp_path: Path, servo: str) -> None:
    model, data = built(tmp_path, servo + MOTOR, "{hold: forces}")
    mujoco.mj_forward(model, data)
    assert np.abs(data.qacc).max() < 1e-5
    assert abs(data.ctrl[1]) > 1


def test_what_cannot_be_balanced_is_reported(tmp_path: Path) -> None:
    tendon = (
        '<tendon><fixed name="t"><joint joint="shoulder" coef="1"/><joint joint="elbow" coef="1"/></fixed></tendon>'
    )
    text = ARM.format('<motor name="m" tendon="t"/>').replace("<actuator>", tendon + "<actuator>")
    (tmp_path / "arm.xml").write_text(text)
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nbase: ./arm.xml\nkeyframe: {up: {qpos: {elbow: 30deg}, ctrl: {hold: forces}}}\n"
    )
    context = Context(environment={}, folder=tmp_path)
    assert build(ModelRequest(tmp_path / "r.yaml"), context) is not None
    assert [each.code for each in context.sink.diagnostics] == ["not-held"]


def test_a_joint_means_its_only_servo(tmp_path: Path) -> None:
    two = SERVOS[0] + '<motor name="x" joint="shoulder"/>'
    _, data = built(tmp_path, two, "{joint: {shoulder: 10deg}}")
    assert data.ctrl.tolist() == [pytest.approx(np.deg2rad(10)), 0]


PID = """<mujoco>
  <extension><plugin plugin="mujoco.pid"><instance name="i"><config key="kp" value="90"/></instance></plugin></extension>"""
UNKNOWN = [
    (PID, '<plugin name="x" joint="shoulder" plugin="mujoco.pid" instance="i"/>', "a plugin"),
    ("<mujoco>", '<general name="x" joint="shoulder" gaintype="user"/>', "own type"),
    ("<mujoco>", '<general name="x" joint="shoulder" biastype="user" gainprm="9"/>', "own type"),
]


@pytest.mark.parametrize("ctrl", ["hold", "{hold: forces}"])
@pytest.mark.parametrize(("head", "actuator", "words"), UNKNOWN)
def test_whose_law_is_not_known_holds_nothing(tmp_path: Path, head: str, actuator: str, words: str, ctrl: str) -> None:
    (tmp_path / "arm.xml").write_text(ARM.replace("<mujoco>", head).format(actuator + MOTOR))
    key = f"up: {{qpos: {{shoulder: -40deg}}, ctrl: {ctrl}}}"
    (tmp_path / "r.yaml").write_text(f"recipe: 1\nbase: ./arm.xml\nkeyframe: {{{key}}}\n")
    context = Context(environment={}, folder=tmp_path)
    made = build(ModelRequest(tmp_path / "r.yaml"), context)
    assert made is not None
    found = [each.message for each in context.sink.diagnostics if each.code == "not-held"]
    assert len(found) == 1 and words in found[0]
    model = mujoco.MjModel.from_xml_string(made.bundle.files["model.xml"].decode())
    assert model.key_ctrl[0, 0] == 0


@pytest.mark.mujoco4("its dcmotor has other inputs")
def test_the_controller_of_a_motor_is_a_servo(tmp_path: Path) -> None:
    dcmotor = '<dcmotor name="s" joint="shoulder" motorconst="0.05" resistance="2" {} input="{}"/>'
    _, data = built(tmp_path, dcmotor.format('controller="3 1 1"', "pos") + MOTOR, "hold")
    assert data.ctrl.tolist() == [pytest.approx(np.deg2rad(-40)), 0]
    _, data = built(tmp_path, dcmotor.format("", "voltage") + MOTOR, "hold")
    assert data.ctrl.tolist() == [0, 0]


@pytest.mark.mujoco4("its dcmotor has other inputs")
@pytest.mark.parametrize("order", [1, -1])
def test_what_has_no_control_has_a_place_in_the_manifest(tmp_path: Path, order: int) -> None:
    passive = '<dcmotor name="s" joint="shoulder" motorconst="0.05" resistance="2" input="none"/>'
    model, data = built(tmp_path, "".join([passive, SERVOS[0].replace('"s"', '"e"')][::order]), "hold")
    assert model.nu == 1 and data.ctrl.tolist() == [pytest.approx(np.deg2rad(-40))]
    assert built(tmp_path, passive, "hold")[0].nu == 0


def test_an_activation_that_the_recipe_writes_stands(tmp_path: Path) -> None:
    servo = SERVOS[2]
    held, _ = built(tmp_path, servo, "hold")
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nbase: ./arm.xml\nkeyframe:\n"
        "  up: {qpos: {shoulder: -40deg, elbow: 30deg}, ctrl: hold, act: {s: 0.25rad}}\n"
    )
    context = Context(environment={}, folder=tmp_path)
    made = build(ModelRequest(tmp_path / "r.yaml"), context)
    assert made is not None, [each.message for each in context.sink.diagnostics]
    model = mujoco.MjModel.from_xml_string(made.bundle.files["model.xml"].decode())
    assert model.key("up").act.tolist() == [0.25] != held.key("up").act.tolist()
    assert model.key("up").ctrl.tolist() == held.key("up").ctrl.tolist()
