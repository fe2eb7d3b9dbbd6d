from __future__ import annotations

import mujoco
import pytest
from mjcompose.mujoco.mirror import mirrored_keys

ARM = """<mujoco><worldbody><body name="{left}_link"><joint name="{left}_pan" axis="0 0 {axis}"/><geom size=".1"/>
  <body name="{left}_hand" pos=".3 {offset} 0"><freejoint/><geom size=".1"/></body></body></worldbody>
  <keyframe>{key}</keyframe></mujoco>"""


def test_names_with_left_and_right_exchanged() -> None:
    text = ARM.replace("<freejoint/>", "").format
    of = text(left="left", axis=1, offset=0.1, key='<key qpos=".5" qvel="2"/>')
    image = text(left="right", axis=-1, offset=-0.1, key="")
    assert mirrored_keys(mujoco, {"texts": [of, image], "axis": 1})["keys"][0]["qpos"] == [0.5]
    turned = text(left="right", axis=1, offset=-0.1, key="")
    found = mirrored_keys(mujoco, {"texts": [of, turned], "axis": 1})["keys"][0]
    assert (found["qpos"], found["qvel"]) == ([-0.5], [-2.0])


def test_free_and_mocap_bodies() -> None:
    text = """<mujoco><worldbody><body name="a" pos="1 2 3" euler="10 20 30"><freejoint name="a"/><geom size=".1"/></body>
      <body name="m" mocap="true" pos="0 1 0"/></worldbody><keyframe>{}</keyframe></mujoco>"""
    key = '<key qpos="1 2 3 .5 .5 .5 .5" qvel="1 2 3 4 5 6" mpos="3 4 5" mquat="0 1 0 0"/>'
    image = text.replace('pos="1 2 3" euler="10 20 30"', 'pos="1 -2 3" euler="-10 20 -30"').replace(
        'pos="0 1 0"', 'pos="0 -1 0"'
    )
    row = mirrored_keys(mujoco, {"texts": [text.format(key), image.format("")], "axis": 1})["keys"][0]
    assert row["qpos"] == pytest.approx([1, -2, 3, 0.5, -0.5, 0.5, -0.5])
    assert row["qvel"] == pytest.approx([1, -2, 3, -4, 5, -6])
    assert row["mpos"] == [3, -4, 5] and row["mquat"] == pytest.approx([0, -1, 0, 0])


RACKS = """<mujoco><worldbody><body name="hand">
  <body name="pinion"><joint name="pinion" axis="0 0 1" range="0 2"/><geom size=".1"/></body>
  <body name="left" pos="0 .1 0"><joint name="left" type="slide" axis="0 1 0" range="0 1"/><geom size=".1"/></body>
  <body name="right" pos="0 -.1 0"><joint name="right" type="slide" axis="0 -1 0" range="0 1"/><geom size=".1"/></body>
  </body></worldbody>
  <equality><joint joint1="left" joint2="pinion" polycoef="0 .05 0 0 0"/>
    <joint joint1="right" joint2="pinion" polycoef="0 {} 0 0 0"/></equality>
  <keyframe>{}</keyframe></mujoco>"""


def test_a_pinion_keeps_the_sign_of_its_range_and_its_racks() -> None:
    of = RACKS.format(".05", '<key qpos="1 .05 .05"/>')
    found = mirrored_keys(mujoco, {"texts": [of, RACKS.format(".05", "")], "axis": 1})
    assert found["keys"][0]["qpos"] == pytest.approx([1, 0.05, 0.05])


def test_a_constraint_that_is_not_reflected_is_a_fault() -> None:
    of = RACKS.format(".05", '<key qpos="1 .05 .05"/>')
    fault = mirrored_keys(mujoco, {"texts": [of, RACKS.format("-.05", "")], "axis": 1})["fault"]
    assert fault["why"] == "equality"
    wider = RACKS.format(".05", "").replace('range="0 2"', 'range="1 2"')
    assert mirrored_keys(mujoco, {"texts": [of, wider], "axis": 1})["fault"]["why"] == "range"


HINGES = """<mujoco><compiler angle="radian"/><worldbody><body name="base"><geom size=".1"/>
  <body name="arm"><joint name="pan" axis="1 0 0" ref="0.3" range="{}"/><geom size=".1"/><body name="tip" pos="0 0 .3"><geom size=".1"/></body></body></body>
</worldbody><keyframe>{}</keyframe></mujoco>"""


def test_a_range_is_reflected_about_the_reference_of_its_joint() -> None:
    """The image of a hinge that turns the other way round, with a reference of 0.3."""
    about_reference = HINGES.format("-0.4 1", '<key qpos="0.8"/>')
    found = mirrored_keys(mujoco, {"texts": [about_reference, HINGES.format("-0.4 1", "")], "axis": 1})
    assert found["keys"][0]["qpos"] == pytest.approx([-0.2])
    about_zero = HINGES.format("-1 1", '<key qpos="0.8"/>')
    fault = mirrored_keys(mujoco, {"texts": [about_zero, HINGES.format("-1 1", "")], "axis": 1})["fault"]
    assert fault["why"] == "range"
    reflected = mirrored_keys(mujoco, {"texts": [about_zero, HINGES.format("-0.4 1.6", "")], "axis": 1})
    assert reflected["keys"][0]["qpos"] == pytest.approx([-0.2])
