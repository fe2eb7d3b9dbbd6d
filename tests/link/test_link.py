from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, placed

from composer.diagnostics.sink import Sink
from composer.link.link import PASSES, finish, link
from composer.link.linking import Linking
from composer.link.part import Part
from composer.tree.write import write

# Two units whose every rule differs.
ONE = """
<mujoco model="one">
  <compiler angle="radian" eulerseq="ZYX" autolimits="false" inertiafromgeom="true" fitaabb="true"/>
  <size nuser_geom="1"/>
  <default><geom friction=".5" density="300"/><joint armature=".1"/><motor gear="2"/></default>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 2 0 0 0 3 1 1 1"/><material name="skin"/></asset>
  <worldbody>
    <geom name="ground" size=".5" material="skin"/>
    <body name="a" euler=".1 .2 .3" pos="0 0 1">
      <joint name="j" range="-1 2" limited="true"/><geom name="g" type="box" mesh="m" user="4"/><site name="top" euler="1 2 3"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    </body>
  </worldbody>
  <actuator><motor name="m" joint="j"/></actuator>
  <keyframe><key name="home" qpos="1" ctrl="2"/></keyframe>
</mujoco>
"""
TWO = """
<mujoco model="two">
  <compiler angle="degree" inertiagrouprange="0 2" boundmass=".1"><lengthrange mode="muscle" inttotal="3"/></compiler>
  <default><geom friction=".9" group="1"/><joint damping=".2" range="-40 50"/>
    <default class="s"><joint type="slide"/></default></default>
  <worldbody>
    <body name="a" euler="10 20 30">
      <joint name="j" ref="5"/><joint name="k" class="s"/><geom name="g" size=".1" user="1 2 3"/><geom group="4" size=".3"/>
      <site name="top" pos="0 0 .2"/>
    </body>
    <body name="b" euler="0 0 90"><freejoint/><geom name="h" size=".1"/></body>
  </worldbody>
  <contact><exclude body1="a" body2="b"/></contact>
  <actuator><muscle name="m" joint="j"/><motor name="n" joint="k"/></actuator>
  <keyframe><key name="home" qpos=".3 .4 1 2 3 0 1 0 0" act=".5"/></keyframe>
</mujoco>
"""


@pytest.mark.parametrize("texts", [(ONE, TWO), (TWO, ONE), (TWO, TWO), (ONE, ONE)])
def test_units_that_differ_in_everything_still_mean_what_they_meant(
    workshop: Workshop, texts: tuple[str, str]
) -> None:
    base, part = texts
    workshop.link(base, Piece(part, place=placed(pos=(1.0, 2.0, 3.0)))).check()
    if part is ONE:
        workshop.link(base, Piece(part, place=placed("site", "top"))).check()


def test_many_parts_at_once(workshop: Workshop) -> None:
    pieces = [
        Piece(ONE, "a/", placed("site", "top")),
        Piece(TWO, "b/", placed(pos=(5.0, 0.0, 0.0), quat=(0.5, 0.5, 0.5, 0.5))),
        Piece(ONE, "c/", placed("body", "b/a")),
        Piece(ONE, "d/", placed("site", "c/top", quat=(0.0, 1.0, 0.0, 0.0))),
        Piece(TWO, "e/", options={"keyframes": "prefix"}),
    ]
    model = workshop.link(ONE, *pieces).check()
    assert model.nkey == 2
    assert model.nq == 4 * 1 + 2 * 9


def test_a_composition_is_a_part_like_any_other(workshop: Workshop) -> None:
    inner = workshop.link(ONE, Piece(TWO, "in/"))
    again = workshop.link(TWO, Piece(inner.xml, "out/"))
    again.check()
    base = workshop.link(inner.xml, Piece(ONE, "new/", placed("site", "in/top")))
    base.check()


def test_linking_is_the_same_twice(workshop: Workshop) -> None:
    pieces = [Piece(ONE, "a/", placed("site", "top")), Piece(TWO, "b/")]
    assert workshop.link(ONE, *pieces).xml == workshop.link(ONE, *pieces).xml


def test_a_copy_of_a_unit_links_to_the_same_text(workshop: Workshop) -> None:
    found = []
    base, part = workshop.unit(BASE), workshop.unit(ONE.replace(' fitaabb="true"', ""))
    for _ in range(2):
        linking = Linking(base.copied(), [Part(part.copied(), "p/")], Sink())
        assert link(linking)
        finish(linking)
        found.append(write(linking.base.root))
    assert found[0] == found[1]
    assert b"p/" not in write(part.root)


def test_the_xml_is_plain(workshop: Workshop) -> None:
    """One element a line, two spaces a level, nothing that says how it was made."""
    linked = workshop.link(ONE, Piece(TWO, "b/"))
    lines = linked.xml.splitlines()
    assert lines[0] == '<mujoco model="one">'
    assert all(line.count("<") <= 2 for line in lines)
    assert all((len(line) - len(line.lstrip())) % 2 == 0 for line in lines)
    assert linked.linking.base.root[0].tag == "compiler"


def test_faults_of_several_passes_are_told_at_once(workshop: Workshop) -> None:
    free = '<joint type="free" damping="1"/>'
    base = BASE.replace("</worldbody>", f'<body name="f">{free}</body></worldbody>')
    base = base.replace("<worldbody>", '<option timestep="2"/><worldbody>', 1)
    part = f"""<mujoco><compiler alignfree="true"/><option timestep="1"/>
      <worldbody><body name="b">{free}</body><site name="mark"/></worldbody>
      <actuator><motor joint="none"/></actuator></mujoco>"""
    linked = workshop.link(
        base, Piece(part, "", placed("site", "mark")), Piece(BASE, "c/", placed("site", "no"))
    )
    assert set(linked.codes) >= {"compiler-setting", "option-conflict", "unknown-name"}
    assert {"name-clash", "attach-place"} <= set(linked.codes)


def test_every_pass_says_what_it_does() -> None:
    for each in PASSES:
        assert each.__doc__
        assert each.__module__.startswith("composer.link.")
