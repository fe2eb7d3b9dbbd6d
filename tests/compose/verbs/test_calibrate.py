"""The verb `calibrate`: the zero of a joint and the delay of an actuator."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.bundle.bundle import Bundle
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

MODEL = """<mujoco>
  <compiler angle="{angle}"/>
  <default><default class="limited"><joint range="{range}"/></default></default>
  <worldbody><body name="b"><joint name="j" axis="0 1 0" class="limited" stiffness="3"/><geom size=".1"/>
    <body name="tip" pos="0.3 0 0"><joint name="slide" type="slide" range="-1 1" limited="false"/><geom size=".1"/>
      <body><joint name="ball" type="ball"/><geom size=".1"/></body></body></body></worldbody>
  <actuator><position name="p" joint="j" kp="1"/></actuator>
</mujoco>"""


def built(edit: str, folder: Path, angle: str = "degree") -> tuple[Bundle | None, Context]:
    limits = {"degree": "-90 45", "radian": f"{-np.pi / 2} {np.pi / 4}"}[angle]
    (folder / "model.xml").write_text(MODEL.format(angle=angle, range=limits))
    recipe = f"recipe: 1\nallow: [license-missing]\nbase: ./model.xml\nedit: [{edit}]\n"
    (folder / "recipe.yaml").write_text(recipe, encoding="utf-8")
    context = Context(folder=folder)
    made = build(ModelRequest(folder / "recipe.yaml"), context)
    return (None if made is None else made.bundle), context


def model_of(edit: str, folder: Path, angle: str = "degree") -> mujoco.MjModel:
    bundle, context = built(edit, folder, angle)
    assert bundle is not None, context.sink.diagnostics
    assert not context.sink.diagnostics
    return mujoco.MjModel.from_xml_string(bundle.files[bundle.model].decode())


def tip(model: mujoco.MjModel, angle: float) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qpos[0] = angle
    mujoco.mj_forward(model, data)
    return np.concatenate((data.body("tip").xpos, [data.qfrc_passive[0]]))


@pytest.mark.parametrize("angle", ["degree", "radian"])
@pytest.mark.parametrize("zero", ["2.5deg", "-0.1rad"])
def test_the_robot_reads_the_zero_where_the_model_has_its_own(zero: str, angle: str, tmp_path: Path) -> None:
    radians = np.radians(float(zero[:-3])) if zero.endswith("deg") else float(zero[:-3])
    plain = model_of("{select: {joint: j}, set: {damping: 0}}", tmp_path, angle)
    moved = model_of(f"{{select: {{joint: j}}, calibrate: {{zero: {zero}}}}}", tmp_path, angle)
    for reading in (-0.7, 0.0, 0.4):
        assert tip(moved, reading + radians) == pytest.approx(tip(plain, reading), abs=1e-12)
    assert moved.jnt_range[0] == pytest.approx(plain.jnt_range[0] + radians)


def test_a_slide_without_a_limit_keeps_its_range(tmp_path: Path) -> None:
    moved = model_of("{select: {joint: slide}, calibrate: {zero: 0.02}}", tmp_path)
    assert moved.qpos0[1] == pytest.approx(0.02)
    assert moved.jnt_range[1] == pytest.approx([-1, 1])


@pytest.mark.skipif(mujoco.mj_versionString() < "4", reason="delays are of MuJoCo 4")
def test_a_delay_has_samples_for_the_time_step(tmp_path: Path) -> None:
    moved = model_of("{select: {actuator: p}, calibrate: {delay: 9.5ms}}", tmp_path)
    assert (moved.actuator_delay[0], moved.actuator_history[0, 0]) == (pytest.approx(0.0095), 5)


@pytest.mark.parametrize(
    ("edit", "code", "text"),
    [
        ("{select: {joint: j}, calibrate: {zero: 2.5}}", "bare-angle", "write `2.5deg` or `2.5rad`"),
        ("{select: {joint: slide}, calibrate: {zero: 2deg}}", "wrong-type", "write it in meters"),
        ("{select: {joint: ball}, calibrate: {zero: 2deg}}", "wrong-type", "select a hinge or a slide"),
        ("{select: {joint: j}, calibrate: {delay: 2ms}}", "wrong-type", "select it: `select: {actuator: NAME}`"),
        ("{select: {joint: j}, calibrate: {}}", "missing-key", "write `zero: -1.3deg`, or `delay: 20ms`"),
    ],
)
def test_what_is_wrong(edit: str, code: str, text: str, tmp_path: Path) -> None:
    bundle, context = built(edit, tmp_path)
    (error,) = context.sink.errors
    assert bundle is None
    assert (error.code, error.help) == (code, text)


def test_a_hinge_without_a_range_has_a_zero(tmp_path: Path) -> None:
    (tmp_path / "free.xml").write_text(
        '<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody></mujoco>'
    )
    text = (
        "recipe: 1\nallow: [license-missing]\nbase: ./free.xml\nedit: [{select: {joint: j}, calibrate: {zero: 2deg}}]\n"
    )
    (tmp_path / "free.yaml").write_text(text)
    made = build(ModelRequest(tmp_path / "free.yaml"), Context(folder=tmp_path))
    assert made is not None
    model = mujoco.MjModel.from_xml_string(made.bundle.files[made.bundle.model].decode())
    assert model.qpos0[0] == pytest.approx(np.radians(2))
    assert not model.jnt_limited[0]
