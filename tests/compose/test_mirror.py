"""A mirrored part is where the mirror image of the other part is, and moves like it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """<mujoco model="arm"><compiler angle="radian"/><option integrator="implicitfast"/><worldbody>
  <body name="base"><geom type="cylinder" size=".05 .05"/>
    <body name="upper" pos="0 0 .1"><joint name="pan" axis="0 0 1"/><joint name="lift" axis="0 1 0" ref="0.1"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
      <body name="fore" pos=".3 0 0" euler="0 0.5 0"><joint name="elbow" axis="0 {elbow} 0" damping="5"/><joint name="roll" axis="1 0 0" damping="1"/>
        <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/>
        <body name="wrist" pos=".3 {offset} .02"><joint name="ball" type="ball" damping="1"/><geom size=".03" pos="0.02 0 0.01"/>
          <body name="ext" pos=".05 0 .03"><joint name="slide" type="slide" axis="0 1 0" damping="9"/><geom size=".02"/>
            <site name="tip" pos="0.02 0 0"/></body></body></body></body></body></worldbody>
  <actuator>
    <position name="pan" joint="pan" kp="100"/><position name="lift" joint="lift" kp="100" gear="{gear}"/>
    <motor name="elbow" joint="elbow"/><velocity name="slide" joint="slide" kv="3"/>
    <general name="roll" joint="roll" dyntype="filter" dynprm="1" gainprm="10" biastype="affine" biasprm="0 -10 -1"/>
  </actuator>
  <keyframe>
    <key name="home" qpos=".3 .5 .7 .2 .8 .6 0 0 .01" ctrl=".3 .4 1 .5 .2" act=".1" qvel="1 2 3 4 5 6 7 8"/>
    <key name="rest" time="2" qpos="-.2 0 0 .1 1 0 0 0 .02"/>
  </keyframe></mujoco>"""
HAND = """<mujoco model="hand"><worldbody><body name="palm"><geom size=".05"/>
  <body name="left_jaw" pos="0 .03 .1"><joint name="left_jaw" type="slide" axis="0 1 0"/><geom size=".01"/></body>
  <body name="right_jaw" pos="0 -.03 .1"><joint name="right_jaw" type="slide" axis="0 -1 0"/><geom size=".01"/></body></body>
  </worldbody><keyframe><key name="home" qpos=".01 .02"/></keyframe></mujoco>"""


def built(folder: Path, recipe: str) -> bytes | list[Diagnostic]:
    plain = {"elbow": 1, "offset": 0, "gear": 2}
    files = {
        "arm.xml": ARM.format(**plain),
        "other.xml": ARM.format(**plain | {"elbow": -1, "gear": -2}),
        "odd.xml": ARM.format(**plain | {"offset": 0.02}),
        "hand.xml": HAND,
        "r.yaml": f"recipe: 1\n{recipe}",
    }
    for name, text in files.items():
        (folder / name).write_text(text)
    context = Context(environment={}, folder=folder)
    done = build(ModelRequest(folder / "r.yaml"), context)
    return list(context.sink.errors) if done is None else done.bundle.files["model.xml"]


def of(folder: Path, recipe: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    found = built(folder, recipe)
    assert isinstance(found, bytes), [each.message for each in found]
    model = mujoco.MjModel.from_xml_string(found.decode())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def apart(model: mujoco.MjModel, data: mujoco.MjData, flip: tuple[int, int, int] = (1, -1, 1)) -> float:
    names = [model.body(n).name for n in range(model.nbody)]
    return max(
        np.abs(flip * data.body(name).xpos - data.body(f"right/{name.removeprefix('left/')}").xpos).max()
        for name in names
        if name.startswith("left/") and name != "left/"
    )


@pytest.mark.parametrize("model", ["arm", "other"])
def test_keys_and_motion_are_reflected(tmp_path: Path, model: str) -> None:
    recipe = (
        f"attach:\n  right: {{model: ./{model}.xml, mirror: {{of: left, across: y, keys: true}}}}\n"
        "  left: {model: ./arm.xml, pos: [0.1, 0.9, 0.5], euler: [10deg, 20deg, -70deg]}\n"
    )
    model_, data = of(tmp_path, recipe)
    assert apart(model_, data) < 1e-12
    assert [model_.key(n).name for n in range(model_.nkey)] == ["home", "rest"]
    for key in range(2):
        mujoco.mj_resetDataKeyframe(model_, data, key)
        mujoco.mj_forward(model_, data)
        assert apart(model_, data) < 1e-9
        for _ in range(100):
            mujoco.mj_step(model_, data)
        assert apart(model_, data) < 1e-6
        assert np.abs(data.qvel).max() > 1e-3


@pytest.mark.parametrize(
    ("place", "own"),
    [
        ("site: shoulder, mate: tip", ""),
        ("body: torso, pos: [0, 1, 0], joint: {type: hinge}", ", body: torso"),
        ("frame: corner, quat: [1, 2, 3, 4]", ", body: world, joint: free"),
        ("pos: [0, 1, 0], joint: free", ", joint: free"),
    ],
)
def test_any_place(tmp_path: Path, place: str, own: str) -> None:
    recipe = (
        "add:\n  - {to: world, frame: {name: corner, pos: [1, 2, 3], euler: [0, 0, 20deg]}}\n"
        "  - to: world\n    body: {name: torso, pos: [0, 0, 1], euler: [0, 0, 30deg], freejoint: {}, geom: {size: [.1]},\n"
        "      site: {name: shoulder, pos: [0, .2, .1], euler: [10deg, 20deg, 30deg]}}\n"
        f"attach:\n  left: {{model: ./arm.xml, drop: [key], {place}}}\n"
        f"  right: {{model: ./arm.xml, drop: [key], mirror: {{of: left, across: y}}{own}}}\n"
    )
    model, data = of(tmp_path, recipe)
    assert apart(model, data) < 1e-12


def test_facing_arms(tmp_path: Path) -> None:
    """Arms that are symmetric across their y axis face each other across x."""
    recipe = (
        "attach:\n  left: {model: ./arm.xml, pos: [-1, 0.1, 0], euler: [0, 0, 20deg]}\n"
        "  right: {model: ./arm.xml, mirror: {of: left, across: x, symmetry: y, keys: true}}\n"
    )
    model, data = of(tmp_path, recipe)
    for key in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        assert apart(model, data, (-1, 1, 1)) < 1e-12


def test_the_left_jaw_is_the_image_of_the_right_one(tmp_path: Path) -> None:
    recipe = "attach:\n  left: {model: ./hand.xml, pos: [0, 1, 0]}\n"
    recipe += "  right: {model: ./hand.xml, mirror: {of: left, across: y, keys: true}}\n"
    model, data = of(tmp_path, recipe)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    joints = [f"{side}/{jaw}_jaw" for side in ("left", "right") for jaw in ("left", "right")]
    assert [float(data.joint(name).qpos[0]) for name in joints] == [0.01, 0.02, 0.02, 0.01]


def test_keys_can_have_a_prefix_and_be_used(tmp_path: Path) -> None:
    recipe = (
        "attach:\n  left: {model: ./arm.xml, pos: [0, 1, 0]}\n"
        "  right: {model: ./arm.xml, keys: prefix, mirror: {of: left, across: y, keys: true}}\n"
        "keyframe: {both: {from: {left: home, right: rest}}}\n"
    )
    model, _ = of(tmp_path, recipe)
    assert {model.key(n).name for n in range(model.nkey)} == {"home", "rest", "right/home", "right/rest", "both"}
    assert model.key("right/rest").time[0] == 2
    assert model.key("both").qpos[9:12].tolist() == [0.2, 0.0, 0.0]


@pytest.mark.parametrize(
    ("model", "rest", "message"),
    [
        ("odd", "", "in the reference configuration, the body `wrist` is 20 mm from its mirror image"),
        ("hand", "", "`left` has the body `base`, and `right` has no counterpart of that name"),
        (
            "arm",
            ", edit: [{select: {joint: pan}, set: {axis: [0, 0.1, 1]}}]",
            "the axis of the joint `pan` is not reflected",
        ),
        (
            "arm",
            ", edit: [{select: {actuator: elbow}, set: {gear: [3]}}]",
            "do not push the joint `elbow` like its mirror image",
        ),
    ],
)
def test_no_mirror_image(tmp_path: Path, model: str, rest: str, message: str) -> None:
    recipe = "attach:\n  left: {model: ./arm.xml, pos: [0, 1, 0]}\n"
    recipe += f"  right: {{model: ./{model}.xml, mirror: {{of: left, across: y, keys: true}}{rest}}}\n"
    found = built(tmp_path, recipe)
    assert isinstance(found, list)
    assert [each.code for each in found] == ["mirror"]
    assert message in found[0].message
