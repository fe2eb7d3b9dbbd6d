"""The verb `datasheet`: gains, limits and armature from a data sheet."""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.language.datasheets import library
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

MODEL = """<mujoco>
  <default><default class="servo"><position kp="9" dampratio="1"/></default></default>
  <worldbody><body name="b"><joint name="j" armature="0.5" damping="3"/><geom size=".1"/>
    <body pos="0 0 .3"><joint name="slide" type="slide"/><geom size=".1"/></body></body></worldbody>
  <actuator>
    <position name="p" joint="j" kp="1"/><position name="c" class="servo" joint="j"/>
    <position name="d" joint="j" kp="2" dampratio="1"/><velocity name="v" joint="j"/>
    <motor name="m" joint="j"/><position name="g" joint="j" gear="-2"/><position name="s" joint="slide"/>
    <intvelocity name="i" joint="j" actrange="-1 1"/>
  </actuator>
</mujoco>"""
SHEETS = """datasheets:
  known: {effort: 10, rated: 4, speed: 5, gear: 10, rotor_inertia: 1e-4, friction: 0.2, damping: 0.1, source: a bench}
  bare: {effort: 10, speed: 5, source: a bench}
  late: {effort: 10, armature: 0.02, delay: 0.005, source: a bench}
"""
J = 1e-4 * 10**2


def made(edit: str, folder: Path, sheets: str = SHEETS) -> mujoco.MjModel | list[tuple[str, str]]:
    (folder / "model.xml").write_text(MODEL)
    (folder / "recipe.yaml").write_text(
        f"recipe: 1\nallow: [license-missing]\nbase: ./model.xml\n{sheets}edit: [{edit}]\n", encoding="utf-8"
    )
    context = Context(folder=folder)
    built = build(ModelRequest(folder / "recipe.yaml"), context)
    if built is None:
        return [(each.code, each.message) for each in context.sink.errors]
    assert not context.sink.diagnostics, [each.message for each in context.sink.diagnostics]
    return mujoco.MjModel.from_xml_string(built.bundle.files["model.xml"].decode())


def one(name: str, given: str, folder: Path) -> tuple[mujoco.MjModel, float, float, list[float]]:
    """The model, and what the actuator does to the joint: stiffness, damping, and the range of its torque."""
    model = made(f"{{select: {{actuator: {name}}}, datasheet: {{{given}}}}}", folder)
    assert isinstance(model, mujoco.MjModel), model
    actuator = model.actuator(name)
    gear = model.actuator(name).gear[0]
    limits = sorted((gear * actuator.forcerange).tolist())
    return model, -actuator.biasprm[1] * gear**2, -actuator.biasprm[2] * gear**2, limits


@pytest.mark.parametrize("name", ["p", "g"])
def test_by_bandwidth(name: str, tmp_path: Path) -> None:
    model, kp, kv, limits = one(name, "model: known, bandwidth: 3, damping_ratio: 0.7", tmp_path)
    omega = 2 * math.pi * 3
    assert (kp, kv) == pytest.approx((J * omega**2, 2 * 0.7 * J * omega))
    assert limits == [-10, 10]
    joint = model.joint("j")
    assert (joint.armature[0], joint.frictionloss[0], joint.damping[0]) == pytest.approx((J, 0.2, 0.1))


def test_it_follows_that_fast(tmp_path: Path) -> None:
    """A step is followed as a second-order system of that bandwidth follows it."""
    model, *_ = one("p", "model: known, bandwidth: 2, inertia: 0.1", tmp_path)
    alone = mujoco.MjModel.from_xml_string(
        "<mujoco><option timestep='1e-4' integrator='implicitfast'/><worldbody><body>"
        f"<joint name='j' armature='{J}' axis='1 0 0'/><inertial pos='0 0 0' mass='1' diaginertia='.1 .1 .1'/>"
        f"</body></worldbody><actuator><position joint='j' kp='{-model.actuator('p').biasprm[1]}'"
        f" kv='{-model.actuator('p').biasprm[2]}'/></actuator></mujoco>"
    )
    data = mujoco.MjData(alone)
    data.ctrl[0] = 0.01
    omega = 2 * math.pi * 2
    seconds = 0.1
    while data.time < seconds - 1e-9:
        mujoco.mj_step(alone, data)
    critically = 1 - (1 + omega * seconds) * math.exp(-omega * seconds)
    assert data.qpos[0] / 0.01 == pytest.approx(critically, abs=2e-3)


def test_by_the_error_of_the_greatest_torque(tmp_path: Path) -> None:
    model, kp, kv, limits = one("p", "model: bare, error: 0.1", tmp_path)
    assert (kp, kv, limits) == (pytest.approx(100), pytest.approx(2), [-10, 10])
    assert model.joint("j").armature[0] == 0.5  # the sheet does not say


def test_a_damping_ratio_goes(tmp_path: Path) -> None:
    _, kp, kv, _ = one("d", "model: known, bandwidth: 3", tmp_path)
    assert kv == pytest.approx(2 * kp / (2 * math.pi * 3))


def test_a_damping_ratio_of_a_class_does_not(tmp_path: Path) -> None:
    edit = "{select: {actuator: c}, datasheet: {model: known, bandwidth: 3}}"
    ((code, message),) = made(edit, tmp_path)  # type: ignore[misc]
    assert code == "wrong-type" and message.startswith("a class gives position `c` a `dampratio`")
    without = "{select: {default: servo}, set: {position: {dampratio: null}}}"
    assert isinstance(made(f"{without}, {edit}", tmp_path), mujoco.MjModel)


def test_velocity_and_torque(tmp_path: Path) -> None:
    _, kp, kv, _ = one("v", "model: known, bandwidth: 3", tmp_path)
    assert (kp, kv) == (0, pytest.approx(J * 2 * math.pi * 3))
    model, *_, limits = one("m", "model: known, effort: rated", tmp_path)
    assert limits == [-4, 4] and model.actuator("m").gainprm[0] == 1


def test_a_delay(tmp_path: Path) -> None:
    model, *_ = one("m", "model: late", tmp_path)
    data = mujoco.MjData(model)
    data.ctrl[model.actuator("m").id] = 1
    forces = []
    for _ in range(5):
        mujoco.mj_step(model, data)
        forces.append(float(data.actuator_force[model.actuator("m").id]))
    assert forces == [0, 0, 0, 1, 1]  # 5 ms, in steps of 2 ms


@pytest.mark.parametrize(
    ("name", "given", "code", "told"),
    [
        ("p", "model: knwn, bandwidth: 1", "unknown-name", "there is no data sheet `knwn`"),
        ("p", "model: known", "missing-key", "is a servo of unknown speed"),
        ("p", "model: bare, bandwidth: 1, error: 0.1", "exclusive-keys", "both `bandwidth` and `error`"),
        ("p", "model: late, error: 0.1", "missing-key", "`kv` needs a speed"),
        ("p", "model: bare, effort: rated, error: 1", "missing-key", "has no rated torque"),
        ("p", "model: bare, effort: full, error: 1", "wrong-keyword", "`effort` of `datasheet` cannot be `full`"),
        ("p", "model: bare, bandwidth: 0", "out-of-range", "must be more than 0"),
        ("p", "model: bare, bandwith: 3", "unknown-key", "`datasheet` has no key `bandwith`"),
        ("p", "bandwidth: 3", "missing-key", "`datasheet` lacks `model`"),
        ("s", "model: bare, error: 0.1", "wrong-type", "does not turn a hinge"),
        ("i", "model: bare, error: 0.1", "wrong-type", "is a `intvelocity`, whose gains a data sheet does not give"),
    ],
)
def test_faults(name: str, given: str, code: str, told: str, tmp_path: Path) -> None:
    found = made(f"{{select: {{actuator: {name}}}, datasheet: {{{given}}}}}", tmp_path)
    assert isinstance(found, list), found
    ((first, message),) = found
    assert told in message and (first == code or code == "exclusive-keys")


def test_what_moves_is_to_be_known(tmp_path: Path) -> None:
    edit = "{select: {joint: j}, set: {armature: 0}}, {select: {actuator: p}, datasheet: {model: bare, bandwidth: 3}}"
    ((code, message),) = made(edit, tmp_path)  # type: ignore[misc]
    assert code == "missing-key" and message.startswith("the inertia that position `p` moves is not known")


@pytest.mark.parametrize(
    ("sheet", "code", "told"),
    [
        ("{effort: 1}", "missing-key", "data sheet `m` lacks `source`"),
        ("{source: x}", "missing-key", "data sheet `m` lacks `effort`"),
        ("{effort: 0, source: x}", "out-of-range", "`effort` of data sheet `m` is 0, and must be more than 0"),
        ("{effort: x, source: x}", "wrong-type", "`effort` of data sheet `m` expects a number"),
        ("{effort: 1, source: 3}", "wrong-type", "`source` of data sheet `m` expects text"),
        ("{effort: 1, source: x, torque: 3}", "unknown-key", "data sheet `m` has no key `torque`"),
        (
            "{effort: 1, source: x, rotor_inertia: 1}",
            "unknown-key",
            "`rotor_inertia` of data sheet `m` belongs to `gear`",
        ),
        ("{effort: 1, source: x, armature: 1, gear: 1, rotor_inertia: 1}", "", "has both `armature` and"),
        ("4", "wrong-type", "data sheet `m` expects a mapping"),
    ],
)
def test_faults_of_a_sheet(sheet: str, code: str, told: str, tmp_path: Path) -> None:
    edit = "{select: {actuator: p}, datasheet: {model: m, error: 1}}"
    found = made(edit, tmp_path, f"datasheets: {{m: {sheet}}}\n")
    assert isinstance(found, list), found
    ((first, message),) = found
    assert told in message and code in ("", first)


def test_every_motor_of_the_library_has_a_source() -> None:
    found = library()
    assert len(found) > 10
    for name, sheet in found.items():
        assert "https://" in sheet.source, name
        assert sheet.effort > 0 and (sheet.rated is None or sheet.rated <= sheet.effort)


def test_the_armature_of_two_stages() -> None:
    """As the rows say it: rotor and gears behind their stages."""
    rows = {
        "unitree-g1-5020": ((0.139, 0.017, 0.169), (1 + 46 / 18, 1 + 56 / 16)),
        "unitree-g1-7520-14": ((0.489, 0.098, 0.533), (4.5, 1 + 48 / 22)),
        "unitree-g1-7520-22": ((0.489, 0.109, 0.738), (4.5, 5)),
        "unitree-g1-4010": ((0.068, 0, 0), (5, 5)),
    }
    for name, ((rotor, first, second), (inner, outer)) in rows.items():
        reflected = 1e-4 * (rotor * (inner * outer) ** 2 + first * outer**2 + second)
        assert library()[name].reflected == pytest.approx(reflected, rel=1e-8), name


def test_the_library_is_used(tmp_path: Path) -> None:
    _, kp, _, limits = one("p", "model: dynamixel-xm430-w350, error: 0.1", tmp_path)
    assert (kp, limits) == (pytest.approx(41), [-4.1, 4.1])
    assert np.isfinite(kp)
