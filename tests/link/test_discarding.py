"""`discardvisual`: what MuJoCo leaves out of the part alone is the judge."""

from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, obj, placed

VISUAL = """
<mujoco><compiler discardvisual="true" {settings}/>
  <default><geom material="mt"/><default class="vis"><geom contype="0" conaffinity="0" group="2"/></default></default>
  <asset>
    <texture name="t" type="2d" builtin="flat" rgb1="1 0 0" width="4" height="4"/>
    <texture type="skybox" builtin="flat" rgb1="1 0 0" width="4" height="4"/>
    <material name="mt" texture="t" rgba=".1 .2 .3 .4"/><material name="lay"><layer texture="t" role="rgb"/></material>
    <mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1" texcoord="0 0 1 0 0 1 1 1"/>
    <mesh name="vis" vertex="0 0 0 2 0 0 0 1 0 0 0 1"/><mesh name="unused" vertex="0 0 0 3 0 0 0 1 0 0 0 1"/>
    <mesh name="both" vertex="0 0 0 3 0 0 0 1 0 0 0 1"/><mesh file="o.obj"/><mesh file="p.obj"/>
  </asset>
  <worldbody><geom size=".1" class="vis"/><light name="l" texture="t"/>
    <body name="b"><joint name="j"/><geom name="c" size=".1" material="lay"/><geom name="cm" type="mesh" mesh="m"/>
      <geom class="vis" type="mesh" mesh="vis"/><geom class="vis" type="mesh" mesh="both" mass="3"/>
      <geom type="mesh" mesh="both"/><geom type="mesh" mesh="o" contype="0" conaffinity="0"/><geom type="mesh" mesh="p"/>
      <geom name="v" size=".2" class="vis"/><site name="s" material="lay"/><site name="s2" pos="1 0 0"/>
      <body pos="0 0 1"><geom class="vis" size=".3"/><geom size=".2" pos="1 0 0"/></body></body>
    <body name="only"><joint/><geom size=".1" class="vis" mass="2"/></body>
    <body name="given"><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><geom size=".1" class="vis"/></body>
    {more}
  </worldbody>
  <tendon><spatial name="tn" material="mt"><site site="s"/><site site="s2"/></spatial></tendon>{after}
</mujoco>"""
FILES = {"o.obj": obj(), "p.obj": obj(0.3)}
COPIES = """
  <replicate count="3" offset="0 1 0" sep="_"><body name="r" pos="0 0 3"><joint/><geom name="g" size=".1" class="vis"/>
    <geom size=".2"/><body pos="1 0 0"><geom type="box" size=".1 .1 .2"/></body></body></replicate>
  <replicate count="2" offset="1 0 0"><geom size=".1" class="vis"/><geom size=".12"/></replicate>"""
REFERENCES = {
    "nothing": "",
    "pair": '<contact><pair geom1="v" geom2="c"/></contact>',
    "sensor": '<sensor><framepos objtype="geom" objname="v"/></sensor>',
    "wrap": '<tendon><spatial><site site="s"/><geom geom="v"/><site site="s2"/></spatial></tendon>',
    "tuple": '<custom><tuple name="t"><element objtype="material" objname="mt"/></tuple></custom>',
    "skin": '<deformable><skin name="k" material="mt" vertex="0 0 0 1 0 0 0 1 0" face="0 1 2"><bone body="b"'
    ' bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2" vertweight="1 1 1"/></skin></deformable>',
}


def visual(settings: str = "", more: str = "", after: str = "") -> str:
    return VISUAL.format(settings=settings, more=more, after=after)


def part(text: str) -> Piece:
    return Piece(text, files=FILES, place=placed(pos=(1.0, 2.0, 0.0)))


@pytest.mark.parametrize("reference", REFERENCES)
@pytest.mark.parametrize("more", ["", COPIES], ids=["plain", "copies"])
def test_a_part_loses_what_it_loses_alone(workshop: Workshop, reference: str, more: str) -> None:
    linked = workshop.link(BASE, part(visual(more=more, after=REFERENCES[reference])))
    linked.check()
    assert "discardvisual" not in linked.xml
    assert sorted(linked.bundled()) == ["assets/part/p.obj"]


@pytest.mark.parametrize(
    "settings", ['settotalmass="7"', 'inertiagrouprange="2 2" boundmass=".1" boundinertia=".1"']
)
def test_the_inertia_stays_under_every_rule(workshop: Workshop, settings: str) -> None:
    workshop.link(BASE, part(visual(settings, COPIES))).check()


def test_a_base_loses_it_and_its_part_does_not(workshop: Workshop) -> None:
    seen = VISUAL.replace('discardvisual="true"', "").format(settings="", more="", after="")
    composed = workshop.link(visual(), part(seen), files=FILES).check()
    assert [composed.mat(at).name for at in range(composed.nmat)] == ["part/mt", "part/lay"]


def test_a_flex_loses_its_material(workshop: Workshop) -> None:
    flex = """<body name="f"><flexcomp name="x" type="grid" count="3 2 1" spacing=".1 .1 .1" radius=".01" dim="2"
      material="mt"><pin id="0"/><edge equality="true"/></flexcomp></body>"""
    # MuJoCo makes texture coordinates only where there is a material, and discards it afterwards.
    workshop.link(BASE, part(visual(more=flex))).check(ignore=["flex_texcoord", "flex_texcoordadr"])


@pytest.mark.mujoco4("the model is refused")
def test_copies_that_are_not_all_discarded_are_told(workshop: Workshop) -> None:
    sensor = '<sensor><framepos objtype="geom" objname="g_1"/></sensor>'
    fault = workshop.link(BASE, part(visual(more=COPIES, after=sensor))).fault
    assert fault.code == "compiler-setting"
    assert "some copies of `<geom>` only" in fault.message
