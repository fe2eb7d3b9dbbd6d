"""What actuators keep and lose in a conversion, as forces, limits and keys; also with a MuJoCo without pid."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from compose.arm import Case, force
from mjcompose.base.diagnostic import Severity

LAW = (
    "actuator_gaintype",
    "actuator_biastype",
    "actuator_dyntype",
    "actuator_gainprm",
    "actuator_biasprm",
    "actuator_ctrlrange",
    "actuator_ctrllimited",
    "actuator_forcerange",
    "actuator_gear",
    "actuator_trnid",
)


@pytest.mark.parametrize("name", ["a1", "a2", "m1", "v1", "f1", "g1"])
def test_any_actuator_is_a_general_one(radian: Case, own: bool, name: str) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited(f"{{select: {{actuator: {name}}}, convert: {{to: general}}}}", own)
    for array in (*LAW, "key_ctrl", "key_act"):
        assert np.array_equal(getattr(before, array), getattr(after, array)), array
    assert not radian.context.sink.diagnostics


@pytest.mark.parametrize(
    ("name", "to"),
    [
        ("g1", "position"),
        ("a1", "pid"),
        ("v1", "pid"),
        ("a2", "general"),
        ("m1", "motor"),
        ("g1", "pid"),
        ("a1", "position"),
    ],
)
def test_what_can_be_kept_is_kept(radian: Case, name: str, to: str) -> None:
    if to == "pid" and not hasattr(mujoco.mjtGain, "mjGAIN_PID"):
        pytest.skip("this MuJoCo has no pid")
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited(f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}")
    assert force(after, name) == pytest.approx(force(before, name), abs=1e-12) != 0
    assert np.array_equal(before.key_ctrl, after.key_ctrl)
    assert not radian.context.sink.diagnostics


def test_what_is_lost_is_told(radian: Case) -> None:
    model = radian.edited("{select: {actuator: a?}, convert: {to: motor, ctrlrange: from-forcerange}}")
    assert model.actuator("a1").ctrlrange == pytest.approx([-50, 50])
    assert force(model, "a1") == pytest.approx(0.4)
    assert [each.severity for each in radian.context.sink.diagnostics] == [Severity.WARNING]
    assert "kp 100 and kv 10 (position `a1`)" in radian.said and "a force now, not a position" in radian.said
    assert model.key("home").ctrl == pytest.approx([0, 0, 0.3, 0.4, 0.5, 0.6]), "they would be forces"
    model = radian.edited("{select: {actuator: a1}, convert: {to: velocity}}")
    assert model.actuator("a1").gainprm[0] == 10 and not model.actuator("a1").ctrllimited[0]
    assert "`ctrlrange`, which limits something else" in radian.said and "its position gain, 100" in radian.said
    model = radian.edited("{select: {actuator: f1}, convert: {to: motor}}")
    assert model.na == 0 and "its dynamics, `filterexact`" in radian.said
    assert model.key("home").ctrl == pytest.approx([0.1, 0.2, 0.3, 0.4, 0, 0.6])


SERVOS = """\
<mujoco>
  <worldbody><body><joint name="j" range="-30 30"/><joint name="k" axis="0 1 0"/><geom size=".1"/></body></worldbody>
  <actuator>
    <pid name="two" joint="k" kp="3" kv="1" posrange="-2 2" velrange="-3 3"/>
    <position name="own" joint="j" kp="7" kv="1" ctrlrange="-1 1"/>
    <position name="free" joint="j" kp="7" kv="1"/>
    <position name="inherits" joint="j" kp="7" inheritrange="0.5"/>
    <position name="damped" joint="j" kp="7" dampratio="1"/>
    <general name="filtered" joint="j" dyntype="filterexact" dynprm=".1" gainprm="5" biastype="affine" biasprm="0 -5 -1"
             actlimited="true" actrange="-.2 .2" actearly="true"/>
    <intvelocity name="rate" joint="j" kp="7" actrange="-1 1" ctrlrange="-2 2"/>
    <pid name="full" joint="j" kp="7" kv="2" ki="4" imax="2" input="pos" posrange="-1 1"/>
    <pid name="slow" joint="j" kp="7" kv="2" slewmax="5" input="pos"/>
    <pid name="plain" joint="j" kp="7" kv="2" input="pos"/>
    <pid name="speed" joint="j" kp="0" kv="2" input="vel" velrange="-4 4"/>
    <pid name="push" joint="j" kp="0" kv="0" input="ff"/>
  </actuator>
  <keyframe><key name="home" ctrl=".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14" act=".1 .2 .3 .4"/></keyframe>
</mujoco>
"""


@pytest.fixture
def servos(tmp_path: Path) -> Case:
    if not hasattr(mujoco.mjtGain, "mjGAIN_PID"):
        pytest.skip("this MuJoCo has no pid")
    return Case(tmp_path, SERVOS)


def limits(model: mujoco.MjModel, name: str) -> list[list[float]]:
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
    first = model.actuator_ctrladr[index]
    rows = range(first, first + model.actuator_ctrlnum[index])
    return [list(model.actuator_ctrlrange[row]) for row in rows if model.actuator_ctrllimited[row]]


@pytest.mark.parametrize(
    ("name", "to"),
    [
        *(
            (name, "general")
            for name in (
                "two",
                "own",
                "free",
                "inherits",
                "damped",
                "filtered",
                "rate",
                "full",
                "slow",
                "plain",
                "speed",
                "push",
            )
        ),
        *(
            (name, name_of)
            for name_of in ("position", "pid")
            for name in ("own", "free", "inherits", "damped", "plain")
        ),
        *((name, "pid") for name in ("two", "full", "slow", "speed", "push")),
        ("speed", "velocity"),
        ("push", "motor"),
    ],
)
def test_limits_gains_and_keys_stay_with_the_actuator(servos: Case, name: str, to: str) -> None:
    before = servos.model("recipe: 1\nbase: ./arm.xml\n")
    after = servos.edited(f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}")
    assert servos.context.sink.diagnostics == []
    for each in re.findall('<.* name="(.*?)" joint', SERVOS)[2:]:
        assert limits(after, each) == limits(before, each), each
    assert np.array_equal(before.key_ctrl, after.key_ctrl) and np.array_equal(before.key_act, after.key_act)
    rng = np.random.default_rng(0)
    for _ in range(5):
        state = [rng.normal(size=size) for size in (before.nq, before.nv, before.nu, before.na)]
        forces = []
        for model in (before, after):
            data = mujoco.MjData(model)
            data.qpos[:], data.qvel[:], data.ctrl[:], data.act[:] = state
            mujoco.mj_step(model, data, 2)
            forces.append([*data.actuator_force, *data.act])
        assert forces[0] == pytest.approx(forces[1], abs=1e-9)


@pytest.mark.parametrize("name", ["two", "full", "slow", "plain", "speed"])
def test_a_pid_comes_back_from_its_general_form(servos: Case, name: str) -> None:
    """All that it has, its integral gain and slew rate too, has to be read from a gain of MuJoCo's kind `pid`."""
    before = servos.model("recipe: 1\nbase: ./arm.xml\n")
    one, two = (f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}" for to in ("general", "pid"))
    after = servos.edited(f"{one}, {two}")
    for array in ("gainprm", "biasprm", "dynprm", "dyntype", "ctrlspec"):
        array = f"actuator_{array}"
        assert np.array_equal(getattr(before, array), getattr(after, array)), array


@pytest.mark.parametrize(
    ("name", "to", "said", "home"),
    [
        ("filtered", "position", "`actrange`|`actearly`", ".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        (
            "rate",
            "position",
            "a position now, not the rate of a position|`ctrlrange`, which",
            ".1 .2 .3 .4 .5 .6 .7 0 .9 .11 .12 .13 .14",
        ),
        ("full", "position", "its integral gain, 4", ".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        ("slow", "position", "its slew rate, 5", ".1 .2 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
        (
            "two",
            "position",
            "a position now, not a position and a velocity|`velrange`",
            "0 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14",
        ),
        (
            "two",
            "motor",
            "kp 3 and kv 1|a force now, not a position and a velocity",
            "0 .3 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14",
        ),
        ("own", "motor", "`ctrlrange`, which limits something else", ".1 .2 0 .4 .5 .6 .7 .8 .9 .11 .12 .13 .14"),
    ],
)
def test_what_servos_lose_is_told(servos: Case, name: str, to: str, said: str, home: str) -> None:
    after = servos.edited(f"{{select: {{actuator: {name}}}, convert: {{to: {to}}}}}")
    assert after.key("home").ctrl == pytest.approx([float(number) for number in home.split()])
    assert [each.code for each in servos.context.sink.diagnostics] == ["convert-loss"]
    for words in said.split("|"):
        assert words in servos.said


def test_a_law_of_its_own_is_lost_and_told(tmp_path: Path) -> None:
    general = 'gaintype="affine" gainprm="1 2 0" biastype="affine" biasprm="1 2 3"'
    arm = Case(
        tmp_path,
        f"""<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
        <actuator><general name="law" joint="j" {general}/></actuator></mujoco>""",
    )
    model = arm.edited("{select: {actuator: law}, convert: {to: position, kp: 5, kv: 1}}")
    assert model.actuator("law").gainprm[0] == 5
    assert "its own gain and bias (`affine`, `affine`)" in arm.said


def test_a_gain_that_there_is_not_must_be_given(radian: Case) -> None:
    assert radian.told("{select: {actuator: m1}, convert: {to: position}}") == ["39 missing-key"]
    model = radian.edited("{select: {actuator: m1}, convert: {to: position, kp: 5, ctrlrange: [-1, 1]}}")
    assert model.actuator("m1").gainprm[0] == 5 and model.actuator("m1").biasprm[:3] == pytest.approx([0, -5, 0])
