"""Controls by the joint: MuJoCo moves the joint to the number of the key, whatever the gear of its actuator."""

from __future__ import annotations

import math
from pathlib import Path

import mjcompose
import mujoco
import pytest

ONE = """
<mujoco model="one"><option gravity="0 0 0" timestep="0.001" integrator="implicitfast"/><default><default class="geared"><general gear="{gear}"/></default></default>
<worldbody><body name="link"><joint name="j" type="{type}" axis="0 1 0" damping="{damping}"/><geom size=".1" mass="1"/></body></worldbody>
<actuator>{actuator}</actuator></mujoco>
"""
KINDS = {
    "position": '<position name="a" joint="j" class="geared" kp="400"/>',
    "in the frame of the parent": '<position name="a" jointinparent="j" class="geared" kp="400"/>',
    "filtered": '<position name="a" joint="j" class="geared" kp="400" timeconst="0.01"/>',
    "of a bias": '<general name="a" joint="j" class="geared" gainprm="10" biastype="affine" biasprm="3 -400 -1"/>',
    "of a pid": '<pid name="a" joint="j" class="geared" input="pos" kp="400"/>',
}
RATES = {
    "velocity": '<velocity name="a" joint="j" class="geared" kv="50"/>',
    "intvelocity": '<intvelocity name="a" joint="j" class="geared" kp="4000" kv="40" actrange="-99 99"/>',
    "of a bias": '<general name="a" joint="j" class="geared" gainprm="40" biastype="affine" biasprm="1 0 -30"/>',
}
FORCES = {
    "motor": '<motor name="a" joint="j" class="geared"/>',
    "with a gain": '<general name="a" joint="j" class="geared" gainprm="50"/>',
    "with a bias": '<general name="a" joint="j" class="geared" gainprm="5" biastype="affine" biasprm="2 0 0"/>',
    "cylinder": '<cylinder name="a" joint="j" class="geared" area="3" timeconst="0.001"/>',
}


def simulated(
    folder: Path, joint: str, actuator: str, gear: float, number: str, damping: float
) -> tuple[object, object]:
    """Simulate 3 s from a key that gives a number by the joint."""
    (folder / "one.xml").write_text(ONE.format(type=joint, actuator=actuator, gear=gear, damping=damping))
    (folder / "r.yaml").write_text(
        f"recipe: 1\nbase: ./one.xml\nallow: [license-missing]\nkeyframe: {{k: {{ctrl: {{joint: {{j: {number}}}}}}}}}\n"
    )
    model = mjcompose.model(folder / "r.yaml")
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for _ in range(3000):
        mujoco.mj_step(model, data)
    return model, data


@pytest.mark.parametrize("gear", [1, 2.5, -1, -0.4])
@pytest.mark.parametrize("joint", ["hinge", "slide"])
@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=pytest.mark.since("3.12", "it has no pid")) if "pid" in kind else kind for kind in KINDS],
)
def test_the_joint_settles_at_the_number_of_its_key(tmp_path: Path, kind: str, joint: str, gear: float) -> None:
    number = "35deg" if joint == "hinge" else "0.4"
    _, data = simulated(tmp_path, joint, KINDS[kind], gear, number, damping=12)
    assert data.qpos[0] == pytest.approx(math.radians(35) if joint == "hinge" else 0.4, abs=1e-4)


@pytest.mark.parametrize("gear", [1, -2, 0.5])
@pytest.mark.parametrize("joint", ["hinge", "slide"])
@pytest.mark.parametrize("kind", RATES)
def test_the_joint_moves_as_fast_as_the_number_of_its_key(tmp_path: Path, kind: str, joint: str, gear: float) -> None:
    number = "70deg" if joint == "hinge" else "0.8"
    _, data = simulated(tmp_path, joint, RATES[kind], gear, number, damping=0)
    assert data.qvel[0] == pytest.approx(math.radians(70) if joint == "hinge" else 0.8, rel=1e-3)


@pytest.mark.parametrize("gear", [1, 30, -4])
@pytest.mark.parametrize("joint", ["hinge", "slide"])
@pytest.mark.parametrize("kind", FORCES)
def test_the_joint_feels_the_force_of_its_key(tmp_path: Path, kind: str, joint: str, gear: float) -> None:
    _, data = simulated(tmp_path, joint, FORCES[kind], gear, "7", damping=3)
    assert data.qfrc_actuator[0] == pytest.approx(7)


@pytest.mark.mujoco4("it has no pid with several inputs")
def test_each_input_of_a_pid_is_at_the_joint(tmp_path: Path) -> None:
    pid = '<pid name="a" joint="j" gear="-2" input="pos vel ff" kp="30" kv="7"/>'
    (tmp_path / "one.xml").write_text(ONE.format(type="hinge", actuator=pid, gear=1, damping=0))
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nbase: ./one.xml\nallow: [license-missing]\n"
        "keyframe: {k: {qpos: {j: 20deg}, qvel: {j: 50deg}, ctrl: {joint: {j: [20deg, 50deg, 6]}}}}\n"
    )
    model = mjcompose.model(tmp_path / "r.yaml")
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert data.qfrc_actuator[0] == pytest.approx(6)
