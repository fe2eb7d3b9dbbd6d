"""Every body of a source, taken from an excerpt and from a copy of the whole source: the result is the same."""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest
from link.workshop import Workshop
from mjcompose.base.sink import Sink
from mjcompose.link.excerpt import ExcerptSource
from mjcompose.link.subtree import take_from_excerpt, take_subtree
from mjcompose.tree.parse import parse_file
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write
from sampling import rest_slow

CORPUS = os.environ.get("MJCOMPOSE_CORPUS")

CROSSED = """\
<mujoco model="crossed">
  <!-- a comment above all -->
  <compiler angle="radian"/>
  <size njmax="300"/>
  <visual><map znear="0.1" zfar="9"/></visual>
  <default>
    <!-- of the top -->
    <geom rgba="1 0 0 1"/>
    <default class="outer"><joint damping="1"/>
      <default class="inner"><geom material="steel"/><camera fovy="30"/></default>
      <default class="unused"><geom material="wood"/></default>
    </default>
  </default>
  <custom>
    <numeric name="free" data="1"/><numeric name="needed" data="2"/>
    <tuple name="both"><element objtype="body" objname="left"/><element objtype="body" objname="right"/></tuple>
    <tuple name="one"><element objtype="body" objname="left"/><element objtype="numeric" objname="needed"/></tuple>
    <tuple name="of one"><element objtype="tuple" objname="one"/></tuple>
  </custom>
  <asset>
    <texture name="grain" type="2d" builtin="flat" width="2" height="2"/>
    <material name="wood" texture="grain"/><material name="steel" texture="grain"/><material name="unused"/>
  </asset>
  <worldbody>
    <!-- of the world -->
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="base" childclass="outer">
      <frame pos="0 0 1" childclass="inner"><!-- of the frame -->
        <body name="left"><joint name="left"/><geom name="left" size=".1"/><site name="left"/>
          <camera name="looks in" mode="targetbody" target="tip"/><light name="looks out" mode="targetbody" target="right"/>
          <body name="tip" pos="0 0 1"><joint name="tip"/><geom name="tip" size=".1"/></body></body>
        <geom name="beside" size=".1"/>
      </frame>
      <body name="right"><joint name="right"/><geom name="right" size=".1"/><site name="right"/></body>
    </body>
  </worldbody>
  <worldbody><body name="other"><joint name="other"/><geom size=".1"/></body></worldbody>
  <contact><exclude body1="left" body2="tip"/><exclude body1="left" body2="right"/></contact>
  <tendon>
    <!-- of the tendons -->
    <fixed name="inside"><joint joint="left" coef="1"/><joint joint="tip" coef="1"/></fixed>
    <fixed name="across"><joint joint="left" coef="1"/><joint joint="right" coef="1"/></fixed>
    <spatial name="rope"><site site="left"/><site site="right"/></spatial>
  </tendon>
  <equality><joint joint1="left" joint2="tip"/><weld body1="left"/><tendon tendon1="inside" tendon2="across"/></equality>
  <actuator><motor name="left" joint="left"/><motor name="across" tendon="across"/><motor name="in" tendon="inside"/></actuator>
  <sensor>
    <jointpos joint="left"/><tendonpos name="far" tendon="across"/><tendonpos name="near" tendon="inside"/><clock name="c"/>
    <framepos name="seen" objtype="site" objname="left" reftype="site" refname="right"/>
    <user name="of an actuator" objtype="actuator" objname="across" dim="1"/>
  </sensor>
</mujoco>
"""


def _names(unit: Unit) -> list[str]:
    return [str(body.get("name")) for body in unit.root.iterfind("worldbody//body[@name]")]


def _check(unit: Unit, body: str, source: ExcerptSource) -> int:
    """Compare both ways to take a body, and return the number of elements that also refer outside."""
    whole = unit.copied()
    excerpt = source.excerpt(body)
    assert excerpt is not None
    from_whole = Sink()
    from_excerpt = Sink()
    taken = take_subtree(whole, body, from_whole)
    excerpted = take_from_excerpt(excerpt, from_excerpt)
    assert write(excerpt.unit.root) == write(whole.root)
    assert from_excerpt.diagnostics == from_whole.diagnostics
    assert taken is not None
    assert excerpted is not None
    assert excerpted.cut == taken.cut
    assert excerpted.dropped == taken.dropped
    assert _places(excerpt.unit) == _places(whole)
    assert [str(comment) for comment in excerpt.unit.header] == [str(comment) for comment in whole.header]
    return len(taken.cut)


def _places(unit: Unit) -> list[object]:
    return [(node.sourceline, unit.origins.owner(node, "-")) for node in unit.root.iter()]


def test_elements_that_refer_across_the_subtree(workshop: Workshop) -> None:
    unit = parse_file(workshop.write(CROSSED), Sink())
    assert unit is not None
    before = write(unit.root)
    source = ExcerptSource.of(unit)
    assert source is not None
    cut = {body: _check(unit, body, source) for body in _names(unit)}
    assert cut == {"base": 0, "left": 11, "tip": 6, "right": 9, "other": 0}
    assert source.excerpt("none") is None
    assert write(unit.root) == before


@pytest.mark.parametrize(
    "text",
    [
        '<mujoco><compiler settotalmass="2"/><worldbody><body name="a"><geom size="1"/></body></worldbody></mujoco>',
        '<mujoco><worldbody><body name="a"><joint/><geom size="1"/></body></worldbody><keyframe><key qpos="1"/></keyframe></mujoco>',
        '<mujoco><worldbody><body name="a"><geom size="1"/></body><replicate count="2"><site name="s"/></replicate></worldbody></mujoco>',
    ],
    ids=["mass", "key", "replicate"],
)
def test_sources_without_excerpts(workshop: Workshop, text: str) -> None:
    unit = parse_file(workshop.write(text), Sink())
    assert unit is not None
    assert ExcerptSource.of(unit) is None


@pytest.mark.skipif(CORPUS is None, reason="MJCOMPOSE_CORPUS is not set")
@pytest.mark.parametrize(
    "robot",
    rest_slow(
        ["franka_emika_panda/panda.xml", "shadow_hand/right_hand.xml", "unitree_g1/g1.xml", "aloha/aloha.xml"],
        quick=["shadow_hand/right_hand.xml"],
    ),
)
def test_bodies_of_a_robot(robot: str) -> None:
    unit = parse_file(Path(str(CORPUS)) / "models" / robot, Sink())
    assert unit is not None
    for section in unit.root.findall("keyframe"):
        unit.root.remove(section)
    source = ExcerptSource.of(unit)
    assert source is not None
    names = _names(unit)
    for body in random.Random(robot).sample(names, min(10, len(names))):
        _check(unit, body, source)
