"""Values that follow from the whole model: the recipe in which they are written does not know it yet."""

from __future__ import annotations

from pathlib import Path

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """
<mujoco model="arm"><worldbody><body name="up"><joint name="j" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" mass="1"/>
  <body name="fore" pos=".3 0 0"><joint name="k" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .2 0 0" size=".02" mass=".5"/>
    <site name="tip" pos=".2 0 0"/></body></body></worldbody>
  <actuator><motor name="m" joint="j" gear="3"/><general name="n" joint="k" gainprm="2" dyntype="filter" dynprm=".1"/></actuator></mujoco>
"""
LOAD = '<mujoco model="load"><worldbody><body name="w"><geom size=".05" mass="2"/></body></worldbody></mujoco>'
INNER = "base: ./arm.xml\nkeyframe: {home: {qpos: {j: 20deg, k: -30deg}, ctrl: {hold: forces}}}"
OUTER = {
    "a load": "attach:\n  a: {model: ./inner.yaml}\n  w: {model: ./load.xml, site: a/tip}",
    "another gravity": "attach: {a: {model: ./inner.yaml}}\noption: {gravity: [0, 0, -1.62]}",
    "another place": "attach: {a: {model: ./inner.yaml, euler: [40deg, 20deg, 0]}}",
    "as a base": "base: ./inner.yaml\nattach: {w: {model: ./load.xml, site: tip}}",
    "a prefix of keys": "attach:\n  a: {model: ./inner.yaml, keys: prefix}\n  w: {model: ./load.xml, site: a/tip}",
    "twice nested": "attach:\n  a: {model: ./between.yaml}\n  w: {model: ./load.xml, site: a/b/tip}",
    "from": "attach:\n  a: {model: ./inner.yaml, drop: [key]}\n  w: {model: ./load.xml, site: a/tip}\n"
    "keyframe: {mine: {from: {a: home}, qpos: {a/j: 60deg}}}",
    "several": "attach:\n  a: {model: ./inner.yaml, pos: [0, 1, 0], replicate: [{count: 2, offset: [0, 1, 0]}]}\n  w: {model: ./load.xml, site: a1/tip}",
    "a mirror": "attach:\n  a: {model: ./inner.yaml, pos: [0, 1, 0]}\n"
    "  b: {model: ./inner.yaml, mirror: {of: a, across: y, keys: true}}\n  w: {model: ./load.xml, site: b/tip}",
    "added": "attach: {a: {model: ./inner.yaml}}\nadd: [{to: a/fore, geom: {type: sphere, size: [0.05], mass: 3, pos: [0, 0, 0.1]}}]",
}


def write(folder: Path, **recipes: str) -> None:
    for name, text in {"arm.xml": ARM, "load.xml": LOAD}.items():
        (folder / name).write_text(text)
    for name, text in recipes.items():
        (folder / f"{name}.yaml").write_text(f"recipe: 1\nallow: [license-missing]\n{text}\n")


@pytest.mark.parametrize("outer", OUTER)
def test_forces_of_a_nested_key_hold_the_whole_model(tmp_path: Path, outer: str) -> None:
    write(tmp_path, inner=INNER, between="attach: {b: {model: ./inner.yaml}}", r=OUTER[outer])
    model = mjcompose.model(tmp_path / "r.yaml", verified=True)
    data = mujoco.MjData(model)
    assert model.nkey
    for key in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, key)
        pose = data.qpos.copy()
        assert np.abs(data.ctrl).min() > 0.01 and np.abs(pose).min() > 0.1
        for _ in range(100):
            mujoco.mj_step(model, data)
        assert data.qpos == pytest.approx(pose, abs=1e-6)


def test_another_actuator_of_the_whole_keeps_its_share(tmp_path: Path) -> None:
    """The outer recipe's own motor on the same joint pushes, and the nested one balances what is left."""
    outer = "attach: {a: {model: ./inner.yaml}}\nactuator: {own: {type: motor, joint: a/j, gear: 2}}\nkeyframe: {k: {from: {a: home}, ctrl: {own: 0.7}}}"
    write(tmp_path, inner=INNER, r=outer)
    model = mjcompose.model(tmp_path / "r.yaml", verified=True)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("k").id)
    mujoco.mj_forward(model, data)
    assert data.actuator("own").ctrl[0] == 0.7
    assert np.abs(data.qacc).max() < 1e-9


def test_an_edit_of_the_outer_recipe_wins(tmp_path: Path) -> None:
    outer = "attach:\n  a: {model: ./inner.yaml}\n  w: {model: ./load.xml, site: a/tip}\nedit: [{select: {key: home}, set: {ctrl: [5, 6]}}]"
    write(tmp_path, inner=INNER, r=outer)
    assert mjcompose.model(tmp_path / "r.yaml").key("home").ctrl.tolist() == [5, 6]
    part = "attach:\n  a: {model: ./inner.yaml, edit: [{select: {key: home}, set: {ctrl: [5, 6]}}]}\n  w: {model: ./load.xml, site: a/tip}"
    write(tmp_path, inner=INNER, r=part)
    assert mjcompose.model(tmp_path / "r.yaml").key("home").ctrl.tolist() == [5, 6]


def faults(folder: Path) -> list[str]:
    context = Context(folder=folder)
    build(ModelRequest(folder / "r.yaml"), context)
    return [f"{each.code} {each.span.file if each.span else ''}" for each in context.sink.diagnostics]


def test_forces_that_are_left_are_those_of_the_whole(tmp_path: Path) -> None:
    """One motor on the sum of two joints cannot hold both of them, except without gravity."""
    coupled = ARM.replace(
        "<actuator>",
        '<tendon><fixed name="t"><joint joint="j" coef="1"/><joint joint="k" coef="1"/></fixed></tendon><actuator>',
    )
    coupled = (
        coupled.replace('<motor name="m" joint="j" gear="3"/>', '<motor name="m" tendon="t"/>')
        .replace("<general", "<!--")
        .replace('dynprm=".1"/>', "-->")
    )
    write(tmp_path, inner=INNER, r="attach: {a: {model: ./inner.yaml}}")
    (tmp_path / "arm.xml").write_text(coupled)
    assert faults(tmp_path) == ["not-held inner.yaml"]
    write(tmp_path, r="attach: {a: {model: ./inner.yaml}}\noption: {gravity: [0, 0, 0]}")
    assert faults(tmp_path) == []
    write(tmp_path, r="attach: {a: {model: ./inner.yaml, drop: [key]}}")
    assert faults(tmp_path) == []


STEPPED = """
<mujoco model="drive"><option timestep="{}"/><worldbody><body name="b"><joint name="j" damping="1"/><geom size=".1"/></body></worldbody>
  <actuator><motor name="m" joint="j"/></actuator></mujoco>
"""
SHEETS = "datasheets: {d: {source: x, effort: 10, delay: 0.012}}\n"
VERB = "edit: [{select: {actuator: m}, datasheet: {model: d}}]"
PART = f"{{model: ./drive.xml, {VERB}}}"
NESTED = "{model: ./inner.yaml, replicate: [{count: 2, offset: [1, 0, 0]}]}"
BY_EDIT = "edit: [{select: {option: '**'}, set: {timestep: 0.003}}]"
DELAYED = {
    "of a part, by the recipe": (f"attach: {{a: {PART}}}\noption: {{timestep: 0.0005}}", 0.0005),
    "of a part, by another part": (f"attach:\n  a: {PART}\n  b: {{model: ./slow.xml}}\nconflict: mujoco", 0.001),
    "of a part, by an edit": (f"attach: {{a: {PART}}}\n{BY_EDIT}", 0.003),
    "of a nested recipe": ("attach: {a: {model: ./inner.yaml}}\noption: {timestep: 0.004}", 0.004),
    "of a copy": (f"attach: {{a: {NESTED}}}\noption: {{timestep: 0.004}}", 0.004),
    "of the base": (f"base: {PART}\noption: {{timestep: 0.006}}", 0.006),
    "of a model alone": (f"base: {PART}", 0.001),
}


@pytest.mark.parametrize("case", DELAYED)
def test_a_delay_is_as_long_as_the_data_sheet_says(tmp_path: Path, case: str) -> None:
    recipe, step = DELAYED[case]
    write(tmp_path, r=SHEETS + recipe, inner=f"{SHEETS}base: ./drive.xml\n{VERB}")
    (tmp_path / "drive.xml").write_text(STEPPED.format(0.001))
    (tmp_path / "slow.xml").write_text(STEPPED.format(0.004))
    model = mjcompose.model(tmp_path / "r.yaml", verified=True)
    assert model.opt.timestep == pytest.approx(step)
    data = mujoco.MjData(model)
    data.ctrl[:] = 1
    arrived = None
    while arrived is None and data.time < 0.1:
        began = data.time
        mujoco.mj_step(model, data)
        arrived = began if data.actuator_force[0] > 0.5 else None
    assert arrived == pytest.approx(0.012, abs=step / 2)


def test_samples_that_someone_wrote_later_stay(tmp_path: Path) -> None:
    later = "edit: [{select: {actuator: a/m}, set: {nsample: 40}}]\noption: {timestep: 0.0005}"
    write(tmp_path, r=f"attach: {{a: {{model: ./inner.yaml}}}}\n{later}", inner=f"{SHEETS}base: ./drive.xml\n{VERB}")
    (tmp_path / "drive.xml").write_text(STEPPED.format(0.001))
    assert mjcompose.model(tmp_path / "r.yaml").actuator_history[0, 0] == 40


SERVO = ARM.replace('<motor name="m" joint="j" gear="3"/>', '<position name="m" joint="j" kp="30" dampratio="0.7"/>')


@pytest.mark.parametrize("to", ["general", "pid, input: [pos]"])
@pytest.mark.mujoco4("it has no pid")
def test_a_damping_ratio_is_of_the_whole_after_convert(tmp_path: Path, to: str) -> None:
    edit = f"edit: [{{select: {{actuator: m}}, convert: {{to: {to}}}}}]"
    recipe = "attach:\n  a: {model: ./arm.xml%s}\n  w: {model: ./load.xml, site: a/tip}"
    write(tmp_path, r=recipe % f", {edit}", plain=recipe % "")
    (tmp_path / "arm.xml").write_text(SERVO)
    converted, plain = (mjcompose.model(tmp_path / f"{each}.yaml") for each in ("r", "plain"))
    alone = mujoco.MjModel.from_xml_string(SERVO)
    assert converted.actuator("a/m").biasprm[:3] == pytest.approx(plain.actuator("a/m").biasprm[:3])
    assert converted.actuator("a/m").biasprm[2] != pytest.approx(alone.actuator("m").biasprm[2])
