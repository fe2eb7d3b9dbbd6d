"""Conversions of every kind of actuator to every kind that there is: what MuJoCo makes of them before and after."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

pytestmark = pytest.mark.mujoco4("it has no pid")

COMMON = 'joint="j" gear="2" group="2" user="1 2"'
LIMITED = 'forcerange="-90 90" '
# Name: kind, attributes, and the kinds to which nothing is lost but the name.
ACTUATORS = {
    "g_motor": ("general", 'gainprm="3" ctrlrange="-1 2" damping=".3" armature=".1"', "general"),
    "g_affine": ("general", 'gaintype="affine" gainprm="1 2 0" biastype="affine" biasprm="1 2 3"', "general"),
    "g_filter": ("general", 'dyntype="filter" dynprm=".1" gainprm="3"', "general"),
    "g_velocity": ("general", 'gainprm="4" biastype="affine" biasprm="0 0 -4" ctrlrange="-2 2"', "general velocity pid"),
    "g_position": ("general", 'gainprm="4" biastype="affine" biasprm="0 -4 0" ctrlrange="-2 2"', "general position pid"),
    "g_inherits": ("general", 'gainprm="4" biastype="affine" biasprm="0 -4 -1" inheritrange="1"', "general position pid"),
    "g_unlimited": ("general", 'gainprm="4" ctrllimited="false" ctrlrange="-1 1"', "general"),
    "motor": ("motor", 'ctrlrange="-1 2"', "general motor"),
    "slow": ("motor", 'nsample="3" delay=".004" interp="linear" ctrlrange="-1 1"', "general motor"),
    "position": ("position", 'kp="4" kv="1" ctrlrange="-1 2"', "general position pid"),
    "inherits": ("position", 'kp="4" inheritrange="1"', "general position pid"),
    "filtered": ("position", 'kp="4" timeconst=".1" ctrlrange="-1 1"', "general position"),
    "unlimited": ("position", 'kp="4" ctrllimited="false" ctrlrange="-1 1"', "general position pid"),
    "velocity": ("velocity", 'kv="4" ctrlrange="-2 2"', "general velocity pid"),
    "v_limited": ("velocity", 'kv="4" ctrllimited="true" ctrlrange="-2 2"', "general velocity pid"),
    "v_unlimited": ("velocity", 'kv="4" ctrllimited="false" ctrlrange="-1 1"', "general velocity pid"),
    "rate": ("intvelocity", 'kp="4" kv="1" actrange="-1 1" ctrlrange="-2 2"', "general"),
    "r_inherits": ("intvelocity", 'kp="4" inheritrange="1"', "general"),
    "damper": ("damper", 'kv="4" ctrlrange="0 2"', "general"),
    "cylinder": ("cylinder", 'timeconst=".1" area="2" bias="1 2 3" ctrlrange="-1 1"', "general"),
    "muscle": ("muscle", 'timeconst=".01 .04" force="5" lengthrange=".1 .3" ctrlrange="0 1"', "general"),
    "dcmotor": ("dcmotor", 'motorconst=".05 .05" resistance="1" ctrlrange="-1 1"', "general"),
    "coil": ("dcmotor", 'motorconst=".05" resistance="2" inductance=".1"', "general"),
    "pid": ("pid", 'kp="3" kv="1" posrange="-2 2" velrange="-3 3"', "general pid"),
    "p_only": ("pid", 'kp="3" kv="1" input="pos" posrange="-1 1"', "general position pid"),
    "v_only": ("pid", 'kp="0" kv="1" input="vel" velrange="-1 1"', "general velocity pid"),
    "f_only": ("pid", 'kp="0" kv="0" input="ff" ffrange="-1 1"', "general motor pid"),
    "three": ("pid", 'kp="3" kv="2" input="pos vel ff" ctrlrange="-1 1" velrange="-2 2" ffrange="-3 3"', "general pid"),
    "unread": ("pid", 'kp="3" kv="2" input="vel" ctrlrange="-1 1"', "general pid"),
}  # fmt: skip
LAW = (
    "gear",
    "trntype",
    "trnid",
    "group",
    "user",
    "forcelimited",
    "forcerange",
    "cranklength",
    "damping",
    "armature",
    "lengthrange",
    "delay",
    "history",
)
# Of a class, which has no `lengthrange`.
NOT_BY_CLASS = {"muscle"}


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    """MuJoCo warns of actuators of one joint that add up to more than is sensible."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def arm(names: Iterable[str], by_class: bool) -> str:
    """The actuators, beside another one, and a key that says what their controls are."""
    classes = ""
    actuators = ""
    for name in names:
        kind, attributes, _ = ACTUATORS[name]
        own = f"{COMMON} {'' if kind == 'dcmotor' else LIMITED}"
        if by_class:
            classes += f'<default class="{name}"><{kind} {attributes}/></default>'
            attributes = f'class="{name}"'
        actuators += f'<{kind} name="{name}" {own} {attributes}/>'
    xml = f"""
    <mujoco><compiler angle="radian"/><default>{classes}</default>
      <worldbody><body>
        <joint name="j" range="-3 3"/><joint name="k" axis="0 1 0"/><geom size=".1" pos=".1 .1 0" mass="99"/>
      </body></worldbody>
      <actuator><motor name="other" joint="k" ctrlrange="-5 5"/>{actuators}</actuator>
      KEYS
    </mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml.replace("KEYS", ""))
    ctrl = " ".join(f"{number / 100}" for number in range(1, model.nu + 1))
    key = f'<key name="home" ctrl="{ctrl}" act="{" ".join([".1"] * model.na)}"/>'
    return xml.replace("KEYS", f"<keyframe>{key}</keyframe>")


def converted(folder: Path, xml: str, names: Iterable[str], to: str) -> tuple[mujoco.MjModel | None, list[Diagnostic]]:
    (folder / "arm.xml").write_text(xml)
    edits = "".join(f"  - {{select: {{actuator: {name}}}, convert: {{to: {to}}}}}\n" for name in names)
    (folder / "recipe.yaml").write_text(f"recipe: 1\nbase: ./arm.xml\nedit:\n{edits}")
    context = Context(environment={}, folder=folder)
    built = build(ModelRequest(folder / "recipe.yaml", verified=False), context)
    found = list(context.sink.diagnostics)
    if built is None:
        return None, found
    return mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode()), found


def limits(model: mujoco.MjModel, name: str) -> list[list[float] | None]:
    """Of each control of the actuator."""
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
    first = int(model.actuator_ctrladr[index])
    return [
        model.actuator_ctrlrange[row].tolist() if model.actuator_ctrllimited[row] else None
        for row in range(first, first + int(model.actuator_ctrlnum[index]))
    ]


def behavior(model: mujoco.MjModel, seed: int) -> list[float]:
    rng = np.random.default_rng(seed)
    data = mujoco.MjData(model)
    data.qpos[:] = rng.normal(size=model.nq)
    data.qvel[:] = rng.normal(size=model.nv)
    data.ctrl[:] = 3 * rng.normal(size=model.nu)
    data.act[:] = rng.normal(size=model.na)
    mujoco.mj_step(model, data, 3)
    return [*data.actuator_force, *data.act, *data.qvel]


def is_law_kept(before: mujoco.MjModel, after: mujoco.MjModel) -> None:
    for array in LAW:
        if hasattr(before, f"actuator_{array}"):
            is_equal = np.array_equal(getattr(after, f"actuator_{array}"), getattr(before, f"actuator_{array}"))
            assert is_equal, array


CASES = [(to, by_class) for to in ("general", "motor", "position", "velocity", "pid") for by_class in (False, True)]


@pytest.mark.parametrize(("to", "by_class"), CASES)
def test_what_is_kept_is_kept(tmp_path: Path, to: str, by_class: bool) -> None:
    names = [name for name, (_, _, lossless) in ACTUATORS.items() if to in lossless.split()]
    if by_class:
        names = [name for name in names if name not in NOT_BY_CLASS]
    xml = arm(names, by_class)
    before = mujoco.MjModel.from_xml_string(xml)
    after, told = converted(tmp_path, xml, names, to)
    assert after is not None and not told
    for name in names:
        assert limits(after, name) == limits(before, name), name
    assert np.array_equal(after.key_ctrl, before.key_ctrl) and np.array_equal(after.key_act, before.key_act)
    for seed in range(3):
        assert behavior(after, seed) == pytest.approx(behavior(before, seed), abs=1e-9)
    is_law_kept(before, after)


LOSSY = {
    "motor": "g_affine g_filter g_velocity g_inherits position inherits unlimited velocity v_limited damper cylinder"
    " pid p_only v_only unread",
    "position": "pid three unread",
    "velocity": "position pid three unread",
}
FIRST_CONTROL_STAYS = {("position", "pid"), ("position", "three"), ("velocity", "unread"), ("motor", "g_filter")}


@pytest.mark.parametrize("by_class", [False, True], ids=["own", "class"])
@pytest.mark.parametrize("to", ["motor", "position", "velocity"])
def test_limits_of_another_control_go(tmp_path: Path, to: str, by_class: bool) -> None:
    """Of what loses something, each is reported; a limit of what is no longer its control would limit something else."""
    names = LOSSY[to].split()
    xml = arm(names, by_class)
    before = mujoco.MjModel.from_xml_string(xml)
    after, told = converted(tmp_path, xml, names, to)
    assert after is not None, told
    assert [each.code for each in told] == ["convert-loss"] * len(names)
    for name in names:
        expected = limits(before, name)[0] if (to, name) in FIRST_CONTROL_STAYS else None
        assert limits(after, name) == [expected], name
    is_law_kept(before, after)


def test_what_a_class_limits_beside_the_first_control_is_reported(tmp_path: Path) -> None:
    _, (loss,) = converted(tmp_path, arm(["pid"], True), ["pid"], "position")
    assert "lost: `velrange`" in [note.message for note in loss.notes]


def test_an_actrange_of_a_class_is_in_the_way(tmp_path: Path) -> None:
    """MuJoCo 4.0 refuses it without an activation, and nothing that the actuator writes undoes it."""
    after, (fault,) = converted(tmp_path, arm(["rate"], True), ["rate"], "position")
    assert after is None and fault.code == "wrong-type"
    assert fault.message == "a `position` cannot have the `actrange` that the class `rate` gives intvelocity `rate`"


def test_what_turns_about_three_axes_does_not_as_a_motor(tmp_path: Path) -> None:
    xml = """
    <mujoco><worldbody><body><joint name="j" type="ball"/><geom size=".1"/></body></worldbody>
      <actuator><orientation name="x" joint="j" kp="3"/></actuator></mujoco>"""
    _, (loss,) = converted(tmp_path, xml, ["x"], "motor")
    assert any("all three axes" in note.message for note in loss.notes)


GEARED = """
<mujoco><compiler angle="radian"/>
  <worldbody>
    <body><joint name="h" axis="0 1 0" range="-1 2"/><geom size=".1" pos=".2 0 0"/></body>
    <body pos="1 0 0"><joint name="s" type="slide" axis="0 1 0" range="-1 2"/><geom size=".1"/></body>
  </worldbody>
  <tendon><fixed name="t"><joint joint="s" coef="2"/></fixed></tendon>
  <actuator>
    <motor name="a" joint="h" gear="80" ctrlrange="-2 2"/>
    <velocity name="b" joint="s" gear="-12" kv=".5" ctrlrange="-9 9"/>
    <motor name="c" tendon="t" gear="3" forcerange="-4 4"/>
    <position name="d" joint="h" gear="7" kp="2" kv="1"/>
  </actuator>
</mujoco>"""


def felt(model: mujoco.MjModel, joint: str, actuator: str) -> tuple[float, float]:
    """The stiffness and the damping of an actuator at a joint or tendon, by small differences."""
    forces = []
    data = mujoco.MjData(model)
    dof = int(model.joint(joint).dofadr[0])
    for name in ("qpos", "qvel"):
        forces.append([])
        for step in (-1e-4, 1e-4):
            mujoco.mj_resetData(model, data)
            getattr(data, name)[dof] = step
            mujoco.mj_forward(model, data)
            moment = np.zeros((len(data.moment_rownnz), model.nv))
            mujoco.mju_sparse2dense(
                moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
            )
            row = model.actuator(actuator).id
            forces[-1].append(moment[row, dof] * data.actuator_force[row])
    return tuple(-(after - before) / 2e-4 for before, after in forces)  # type: ignore[return-value]


@pytest.mark.parametrize("to", ["position", "pid"])
@pytest.mark.parametrize(("name", "joint", "coefficient"), [("a", "h", 1), ("b", "s", 1), ("c", "s", 2), ("d", "h", 1)])
def test_a_joint_feels_the_gains_of_the_recipe_through_a_gear(
    tmp_path: Path, name: str, joint: str, coefficient: int, to: str
) -> None:
    spans = "" if to == "pid" else ", ctrlrange: [-0.5rad, 1rad]"
    model, _ = converted(tmp_path, GEARED, [name], f"{to}, kp: 150, kv: 6, forcerange: [-30, 60]{spans}")
    assert model is not None
    assert felt(model, joint, name) == pytest.approx((150 * coefficient**2, 6 * coefficient**2))
    gear = model.actuator(name).gear[0]
    assert sorted(gear * model.actuator(name).forcerange) == pytest.approx([-30, 60])
    if spans:
        assert sorted(model.actuator(name).ctrlrange / gear) == pytest.approx([-0.5, 1])


SERVO = {
    "input": ["pos", "vel", "ff"],
    "kp": 90,
    "kv": 3,
    "ki": 60,
    "imax": 0.05,
    "slewmax": 0.7,
    "posrange": [-0.4, 0.6],
    "velrange": [-1, 2],
    "ffrange": [-9, 5],
}


@pytest.mark.parametrize(("name", "gear"), [("a", 80), ("b", -12), ("d", 7)])
def test_a_joint_moves_as_with_the_same_pid_without_a_gear(tmp_path: Path, name: str, gear: float) -> None:
    """The sizes of a negative gear have no sign: MuJoCo 4.0 refuses an `imax` or a `slewmax` below 0."""
    written = ", ".join(f"{each}: {value}" for each, value in SERVO.items())
    model, _ = converted(tmp_path, GEARED, [name], f"pid, {written}")
    assert model is not None
    held = re.search(rf'name="{name}" (joint="\w")', GEARED)
    numbers = {each: " ".join(map(str, value if isinstance(value, list) else [value])) for each, value in SERVO.items()}
    plainly = " ".join(f'{each}="{value}"' for each, value in numbers.items())
    plain = re.sub(rf'<\w+ name="{name}" .*', f'<pid name="{name}" {held[1]} {plainly}/>', GEARED)  # type: ignore[index]
    ends = []
    for each, by in ((model, gear), (mujoco.MjModel.from_xml_string(plain), 1)):
        data = mujoco.MjData(each)
        first = each.actuator_ctrladr[each.actuator(name).id]
        for control in ((0.9, 0.1, 0), (0.2, 3, -1), (-0.9, -3, 20)):
            data.ctrl[first : first + 3] = np.array(control) * (by, by, 1 / by)
            mujoco.mj_step(each, data, 150)
            ends.append([*data.qpos, *data.qvel])
    assert np.allclose(ends[:3], ends[3:], rtol=1e-6, atol=1e-9) and np.abs(ends).max() > 0.1


def test_values_now_are_those_of_the_joint(tmp_path: Path) -> None:
    model, told = converted(tmp_path, GEARED, ["d"], 'position, kp: "${value * 3}"')
    assert model is not None and not told
    assert felt(model, "h", "d") == pytest.approx((3 * 2 * 49, 49))


def test_taken_over_or_general_numbers_are_those_of_the_actuator(tmp_path: Path) -> None:
    model, _ = converted(tmp_path, GEARED, ["a"], "position, kp: 150, forcerange: from-ctrlrange")
    assert model is not None and model.actuator("a").forcerange.tolist() == [-2, 2]
    model, _ = converted(tmp_path, GEARED, ["d"], "general, forcerange: [-1, 2]")
    assert model is not None and model.actuator("d").forcerange.tolist() == [-1, 2]


def test_the_range_of_a_joint_is_not_that_of_a_geared_control(tmp_path: Path) -> None:
    """MuJoCo 4.0 ignores the gear: `inheritrange` would stop the joint at an eightieth of its range."""
    model, (fault,) = converted(tmp_path, GEARED, ["a"], "position, kp: 150, inheritrange: 1")
    assert model is None and fault.code == "not-supported" and "80 times" in fault.message


PLUGIN = """
<mujoco><extension><plugin plugin="mujoco.pid"><instance name="i"><config key="kp" value="40"/></instance></plugin></extension>
  <worldbody><body><joint name="j"/><geom size=".1" pos=".2 0 0"/></body></worldbody>
  <actuator>
    <plugin name="p" joint="j" plugin="mujoco.pid" instance="i" ctrlrange="-1 1"/>
    <plugin name="q" joint="j" plugin="mujoco.pid"><config key="kp" value="3"/></plugin>
  </actuator></mujoco>"""


@pytest.mark.parametrize("name", ["p", "q"])
@pytest.mark.parametrize("to", ["general", "motor", "position, kp: 40", "velocity, kv: 2", "pid, kp: 2"])
def test_a_plugin_is_no_motor(tmp_path: Path, name: str, to: str) -> None:
    model, (loss,) = converted(tmp_path, PLUGIN, [name], to)
    assert model is not None and model.actuator_plugin.tolist().count(-1) == 1
    assert loss.code == "convert-loss" and any("plugin" in note.message for note in loss.notes)


@pytest.mark.parametrize("names", ["p", "pr"])
def test_an_instance_of_a_plugin_is_there_as_long_as_an_actuator_has_it(tmp_path: Path, names: str) -> None:
    shared = PLUGIN.replace(
        "<plugin name", '<plugin name="r" joint="j" plugin="mujoco.pid" instance="i"/><plugin name', 1
    )
    model, _ = converted(tmp_path, shared, names, "motor")
    assert model is not None and model.nplugin == 3 - len(names)


def test_a_type_of_a_user_is_no_motor(tmp_path: Path) -> None:
    xml = PLUGIN[: PLUGIN.index("<actuator>")].replace("<extension>", "<!--").replace("</extension>", "-->")
    xml += '<actuator><general name="u" joint="j" gaintype="user" biastype="user"/></actuator></mujoco>'
    _, (loss,) = converted(tmp_path, xml, ["u"], "motor")
    assert any("`user`, `user`" in note.message for note in loss.notes)
