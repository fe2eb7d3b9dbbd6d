"""`fusestatic` and `discardvisual`: what MuJoCo makes of the part alone is the judge."""

from __future__ import annotations

import mujoco
import pytest
from link.workshop import BASE, Piece, Workshop, hinge, obj, placed
from mjcompose.link.inertia import static_bodies

BOTH = """
<mujoco><compiler fusestatic="true" discardvisual="true"/><worldbody>
  <body name="b"><joint/><geom size=".1"/><geom size=".2" contype="0" conaffinity="0"/>
    <body name="c" pos="1 0 0"><geom size=".3" contype="0" conaffinity="0"/></body></body>
</worldbody></mujoco>"""


def test_one_compilation_serves_both_settings(workshop: Workshop) -> None:
    composed = workshop.link(BASE, BOTH).check()
    assert (composed.nbody, composed.ngeom) == (2, 1)


def test_both_places_at_once(workshop: Workshop) -> None:
    workshop.link(BOTH, BOTH).check()


def test_a_model_alone_leaves_it_to_mujoco(workshop: Workshop) -> None:
    linked = workshop.link(BOTH, measure=None)
    assert 'fusestatic="true" discardvisual="true"' in linked.xml
    linked.check()


@pytest.mark.parametrize("setting", ["fusestatic", "discardvisual"])
def test_without_mujoco_at_hand_it_is_told(workshop: Workshop, setting: str) -> None:
    fault = workshop.link(BASE, f'<mujoco><compiler {setting}="true"/></mujoco>', measure=None).fault
    assert fault.code == "compiler-setting" and f"`{setting}`" in fault.message


def test_a_part_that_mujoco_rejects_is_told_by_its_own_names(workshop: Workshop) -> None:
    part = '<mujoco><compiler fusestatic="true"/><worldbody><body name="b"><geom name="g"/></body></worldbody></mujoco>'
    fault = workshop.link(BASE, part).fault
    assert fault.code == "mujoco-rejects" and "`g`" in fault.message


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


@pytest.mark.parametrize("settings", ['settotalmass="7"', 'inertiagrouprange="2 2" boundmass=".1" boundinertia=".1"'])
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
    assert "only some copies of `<geom>`" in fault.message


ARM = """
<mujoco model="base"><worldbody><body name="arm" pos="0 0 1"><joint name="a"/><geom name="a" size=".1"/>
  <site name="mark" pos="1 2 3" euler="10 20 30"/></body></worldbody></mujoco>"""
TREE = """
<mujoco><compiler fusestatic="true" {settings}/>
  <default><geom size=".15"/><default class="small"><geom type="box" size=".1 .1 .2"/></default></default>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 2 0 0 0 3 1 1 1"/></asset>
  <worldbody>
    <body name="root" pos="1 2 3" euler="10 20 30"><geom name="r" size=".1"/><site name="s"/><geom size=".2"/>
      <body name="a" pos="0 1 0" euler="3 4 5"><geom name="a" size=".1"/><joint name="j"/>
        <body name="b" pos="0 1 0" euler="3 4 5" childclass="small"><geom name="b" size=".1"/><geom size=".3"/>
          <body name="c" pos="0 1 0" euler="3 4 5"><geom name="c"/><site name="t" pos="1 2 3"/>
            <camera name="c" pos="1 2 3"/><light name="l" pos="1 2 3" dir="1 1 1"/></body>
          <body name="d" pos="0 1 0" euler="3 4 5"><geom name="d" size=".1"/><joint/></body>
          <body pos="0 1 0" euler="3 4 5"><inertial pos="1 2 3" mass="3" diaginertia="1 1 1"/><geom/></body>
        </body>
        <geom name="a2" size=".2"/><geom size=".21"/>
        <body name="g" pos="0 1 0" euler="3 4 5"><geom name="g" size=".1"/><joint/></body>
        <frame pos="3 4 5" euler="1 2 3"><geom type="box" size=".1 .2 .3"/>
          <body pos="0 0 1"><geom size=".2"/><geom type="mesh" mesh="m" pos="1 2 3" euler="4 5 6"/></body>
          <geom size=".33"/></frame>
      </body>
      <geom name="r2" size=".1"/>
    </body>
  </worldbody>{more}
</mujoco>"""
SETTINGS = (
    "",
    'settotalmass="7"',
    'inertiafromgeom="true"',
    'inertiafromgeom="false" boundmass="1" boundinertia="1"',
    'inertiagrouprange="1 2" boundmass=".1" boundinertia=".1"',
    'balanceinertia="true" discardvisual="true"',
)


def tree(settings: str = "", more: str = "") -> str:
    return TREE.format(settings=settings, more=more)


@pytest.mark.parametrize("settings", SETTINGS)
@pytest.mark.mujoco4("fusing bodies leaves cameras and lights where they were")
def test_a_part_is_fused_as_alone(workshop: Workshop, settings: str) -> None:
    there = placed(pos=(1.0, 2.0, 3.0), quat=(0.5, 0.5, 0.5, 0.5))
    linked = workshop.link(BASE, Piece(tree(settings), place=there))
    composed = linked.check()
    assert [composed.body(at).name for at in range(composed.nbody)] == ["world", "part/a", "part/d", "part/g"]
    assert "fusestatic" not in linked.xml


@pytest.mark.parametrize("settings", SETTINGS)
@pytest.mark.mujoco4("fusing bodies leaves cameras and lights where they were")
def test_a_base_is_fused_as_alone_and_its_part_is_not(workshop: Workshop, settings: str) -> None:
    workshop.link(tree(settings), ARM.replace("<joint", '<body name="still"/><joint')).check()


TO_BODIES = {
    "sensor": '<sensor><framepos objtype="xbody" objname="b"/></sensor>',
    "force": '<sensor><force site="t"/></sensor>',
    "exclude": '<contact><exclude body1="b" body2="d"/></contact>',
    "equality": '<equality><connect body1="c" body2="g" anchor="0 0 0"/></equality>',
    "tuple": '<custom><tuple name="t"><element objtype="body" objname="c"/></tuple></custom>',
    "geom": '<sensor><framepos objtype="geom" objname="b"/></sensor>',
    "pair": '<contact><pair geom1="r" geom2="c"/></contact>',
    "tendon": '<tendon><spatial><site site="s"/><site site="t"/></spatial></tendon>',
    "key": '<keyframe><key qpos="0 1 2"/></keyframe>',
}


@pytest.mark.parametrize("reference", TO_BODIES)
@pytest.mark.mujoco4("fusing bodies leaves cameras and lights where they were")
def test_mujoco_says_which_bodies_stay(workshop: Workshop, reference: str) -> None:
    workshop.link(BASE, tree(more=TO_BODIES[reference])).check()


@pytest.mark.mujoco4("fusing bodies leaves cameras and lights where they were")
def test_what_the_world_takes_up_has_no_mass_on_a_body(workshop: Workshop) -> None:
    linked = workshop.link(ARM, Piece(tree(), place=placed("site", "mark")))
    composed = linked.check()
    assert composed.body("arm").mass == linked.alone(0).body("arm").mass
    assert composed.body("part/a").parentid == composed.body("arm").id
    (told,) = linked.sink.diagnostics
    assert told.severity == "warning" and "has no mass" in told.message
    assert told.span is not None and told.span.line == 2


def test_in_the_world_nothing_is_told(workshop: Workshop) -> None:
    assert workshop.link(ARM, tree()).sink.diagnostics == []


def test_on_a_joint_of_its_own_the_root_keeps_its_mass(workshop: Workshop) -> None:
    linked = workshop.link(ARM, Piece(tree(), place=placed("site", "mark"), options={"joints": (hinge(),)}))
    composed = linked.model()
    assert linked.sink.diagnostics == []
    assert composed.body("part/root").mass > 0
    assert composed.body("part/a").mass == linked.alone(1).body("a").mass
    assert mujoco.mj_name2id(composed, mujoco.mjtObj.mjOBJ_BODY, "part/b") == -1


def test_things_can_be_hung_where_a_body_was(workshop: Workshop) -> None:
    assert workshop.link(tree(), Piece(BASE, place=placed("body", "b"))).fault.help == (
        "`b` is a frame: write `frame: b`"
    )
    workshop.link(tree(), Piece(BASE, place=placed("frame", "b"))).model()


def test_a_frame_keeps_the_name_that_a_body_has_too(workshop: Workshop) -> None:
    part = """<mujoco><compiler fusestatic="true"/><worldbody>
      <frame name="x"><geom name="g" size=".1"/></frame><body name="x"><geom name="h" size=".1"/></body>
      </worldbody></mujoco>"""
    linked = workshop.link(BASE, part)
    linked.check()
    assert linked.xml.count('name="part/x"') == 1


REPLICATED = """
<mujoco><compiler fusestatic="true"/><worldbody>
  <replicate count="3" offset="0 1 0" sep="_"><body name="r"><joint/><geom size=".1"/>
    <body name="s" pos="1 0 0"><geom type="box" size=".1 .1 .2"/></body></body></replicate>
  <body name="b"><joint/><geom size=".1"/>
    <replicate count="2" offset="1 0 0"><body name="c" pos="0 0 1"><geom size=".1"/></body></replicate></body>
</worldbody>{more}</mujoco>"""


def test_copies_are_fused(workshop: Workshop) -> None:
    workshop.link(BASE, REPLICATED.format(more="")).check()


@pytest.mark.mujoco4("the model is refused")
def test_copies_that_are_not_all_fused_are_told(workshop: Workshop) -> None:
    sensor = '<sensor><framepos objtype="xbody" objname="s_1"/></sensor>'
    fault = workshop.link(BASE, REPLICATED.format(more=sensor)).fault
    assert fault.code == "compiler-setting"
    assert "only some copies of `<body>`" in fault.message
    assert fault.span is not None and fault.span.line == 4


FLEXIBLE = """
<mujoco><compiler fusestatic="true"/><default><default class="x"><joint armature="2"/></default></default><worldbody>
  <body name="b" {childclass}><geom size=".1"/><flexcomp name="c" type="grid" count="2 2 1" spacing="1 1 1" dim="2"
    mass="1" radius=".01"/></body></worldbody></mujoco>"""


def test_a_flexcomp_keeps_the_class_of_its_joints(workshop: Workshop) -> None:
    workshop.link(BASE, FLEXIBLE.format(childclass="")).check()
    fault = workshop.link(BASE, FLEXIBLE.format(childclass='childclass="x"')).fault
    assert fault.code == "compiler-setting" and "`<flexcomp>`" in fault.message


def test_static_bodies(workshop: Workshop) -> None:
    unit = workshop.unit(tree())
    assert [body.get("name") for body in static_bodies(unit)] == ["root"]
    assert static_bodies(workshop.unit('<mujoco><worldbody><body mocap="true"/></worldbody></mujoco>')) == []
