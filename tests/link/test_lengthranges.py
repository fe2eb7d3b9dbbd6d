from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, hinge, placed

MUSCLES = """
<mujoco>
  <compiler>{rules}</compiler>
  <worldbody>
    <body name="b"><joint name="j" range="-30 50"/><geom size=".1"/><site name="p" pos=".2 0 0"/></body>
    <site name="q" pos=".5 .5 0"/>
  </worldbody>
  <tendon><spatial name="t"><site site="p"/><site site="q"/></spatial></tendon>
  <actuator>
    <muscle tendon="t"/><motor joint="j"/><muscle joint="j"/><muscle joint="j" lengthrange="0 3"/>
    <position joint="j"/>
  </actuator>
</mujoco>
"""
RULES = [
    'mode="all"',
    'mode="muscle" inttotal="3"',
    'mode="muscleuser" useexisting="false"',
    'uselimit="true"',
]


@pytest.mark.parametrize("rule", RULES)
def test_muscles_keep_the_range_that_their_own_rules_give(workshop: Workshop, rule: str) -> None:
    muscles = MUSCLES.format(rules=f"<lengthrange {rule}/>")
    workshop.link(BASE, muscles).check()
    linked = workshop.link(muscles, BASE)
    linked.check()
    assert "<lengthrange" not in linked.xml


def test_the_rules_of_one_part_do_not_reach_another(workshop: Workshop) -> None:
    plain, ruled = MUSCLES.format(rules=""), MUSCLES.format(rules='<lengthrange mode="all" uselimit="true"/>')
    workshop.link(plain, ruled).check()


def test_a_model_alone_keeps_its_rules(workshop: Workshop) -> None:
    linked = workshop.link(MUSCLES.format(rules='<lengthrange mode="none"/>'))
    assert '<lengthrange mode="none"/>' in linked.xml
    linked.check()


def test_a_muscle_without_any_range_cannot_be_kept(workshop: Workshop) -> None:
    muscles = MUSCLES.format(rules='<lengthrange mode="none"/>')
    fault = workshop.link(BASE, muscles).fault
    assert fault.code == "compiler-setting"
    assert "lengthrange" in fault.message


def test_without_muscles_no_range_is_fine(workshop: Workshop) -> None:
    part = """<mujoco><compiler><lengthrange mode="none"/></compiler><worldbody>
      <body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
      <actuator><motor joint="j"/></actuator></mujoco>"""
    workshop.link(BASE, part).check()


def test_actuators_that_mujoco_copies_cannot_be_measured(workshop: Workshop) -> None:
    part = """<mujoco><compiler><lengthrange mode="all"/></compiler><worldbody><replicate count="2" offset="1 0 0">
      <body name="b"><joint name="j" range="0 10"/><geom size=".1"/></body></replicate></worldbody>
      <actuator><motor joint="j"/></actuator></mujoco>"""
    fault = workshop.link(BASE, part).fault
    assert fault.code == "compiler-setting"
    assert "copies of actuators" in fault.message


def test_muscles_keep_the_range_that_they_have_alone_where_something_hangs_on_them(
    workshop: Workshop,
) -> None:
    arm = """<mujoco><worldbody><body name="b"><joint name="j" range="-30 50"/><geom size=".1"/><site name="p" pos=".2 0 0"/>
        <body name="c" pos=".3 0 0"><joint name="k" axis="0 1 0" range="-30 50"/><geom size=".05" pos=".1 0 0"/>
          <site name="r" pos=".1 .02 0"/></body></body>
      <geom size=".1"/><site name="q" pos=".5 .5 0.2"/></worldbody>
      <tendon><spatial name="t"><site site="p"/><site site="q"/></spatial>
        <spatial name="u"><site site="r"/><site site="q"/></spatial></tendon>
      <actuator><muscle name="m" tendon="t"/><muscle name="n" tendon="u"/><motor name="o" joint="j"/></actuator></mujoco>"""
    load = '<mujoco><worldbody><body name="w"><geom size=".3" mass="9"/></body></worldbody></mujoco>'
    workshop.link(arm, Piece(load, place=placed("body", "c"))).check()
    workshop.link(BASE, Piece(arm, options={"joints": (hinge(name="part/"),)})).check()
    assert "lengthrange" not in workshop.link(arm, load).xml
