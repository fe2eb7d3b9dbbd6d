from __future__ import annotations

import re

import pytest
from link.workshop import BASE, Piece, Workshop, placed

EVERYTHING = """
<mujoco model="everything">
  {defaults}
  <asset>
    <mesh name="wedge" vertex="0 0 0  .1 0 0  0 .1 0  0 0 .1"/>
    <texture name="checks" type="2d" builtin="checker" width="8" height="8"/>
    <texture name="around" type="cube" builtin="gradient" width="4" height="4"/>
    <material name="skin"/>
  </asset>
  <worldbody>
    <geom name="still" size=".1"/>
    <site name="still"/>
    <light name="still"/>
    <camera name="still"/>
    <body name="one">
      <joint name="one"/>
      <geom name="one" size=".1"/>
      <geom type="mesh" mesh="wedge" material="skin"/>
      <site name="one"/>
      <light/>
      <camera/>
      <frame pos="0 1 0">
        <body name="two">
          <joint name="two" axis="1 0 0"/><joint name="slide" type="slide"/>
          <geom name="two" size=".1"/><site name="two"/>
        </body>
      </frame>
    </body>
    <body name="free"><freejoint/><geom size=".1"/></body>
    <body name="loose"><joint type="free"/><geom size=".1"/></body>
  </worldbody>
  <contact><pair geom1="one" geom2="still"/></contact>
  <tendon>
    <spatial name="cord"><site site="one"/><site site="two"/></spatial>
    <fixed name="sum"><joint joint="one" coef="1"/></fixed>
  </tendon>
  <equality>
    <connect body1="one" anchor="0 0 0"/>
    <weld body1="two"/>
    <joint joint1="one"/>
    <tendon tendon1="cord"/>
  </equality>
  <actuator>
    <motor joint="one" lengthrange="0 1"/>
    <position joint="one" lengthrange="0 1"/>
    <velocity joint="one" lengthrange="0 1"/>
    <intvelocity joint="one" actrange="-1 1" lengthrange="0 1"/>
    <damper joint="one" ctrlrange="0 1"/>
    <cylinder joint="one" lengthrange="0 1"/>
    <muscle joint="one" lengthrange="0 1"/>
    <adhesion body="one" ctrlrange="0 1"/>
    <general joint="one" lengthrange="0 1"/>
  </actuator>
</mujoco>
"""

SETTINGS = [
    '<joint damping="3" armature=".2" axis="0 1 0"/>',
    '<geom friction=".3 .02" rgba="1 0 0 1" density="333" solimp=".8"/>',
    '<site rgba="0 1 0 1" size=".3"/>',
    '<camera fovy="30"/>',
    '<light castshadow="false" diffuse="1 0 0"/>',
    '<mesh scale="2 1 1"/>',
    '<texture rgb1="1 0 0"/>',
    '<material shininess=".1" texture="checks"/>',
    '<pair condim="6" friction=".1 .2"/>',
    '<equality solref=".05 1" active="false"/>',
    '<tendon width=".07" damping="2"/>',
    '<general gear="5" forcerange="-3 3"/>',
    '<motor gear="6"/>',
    '<position kp="50" kv="2"/>',
    '<velocity kv="7"/>',
    '<intvelocity kp="8"/>',
    '<damper kv="9" ctrlrange="0 1"/>',
    '<cylinder area="2"/>',
    '<muscle force="11"/>',
    '<adhesion gain="12" ctrlrange="0 1"/>',
]
PLAIN = EVERYTHING.format(defaults="")
ASIDE = placed(pos=(3.0, 0.0, 0.0))


def having(*settings: str) -> str:
    return EVERYTHING.format(defaults=f"<default>{''.join(settings)}</default>")


@pytest.mark.parametrize("setting", SETTINGS)
def test_the_base_keeps_its_top_class_to_itself(workshop: Workshop, setting: str) -> None:
    workshop.link(having(setting), Piece(PLAIN, place=ASIDE)).check()


@pytest.mark.parametrize("setting", SETTINGS)
def test_a_part_keeps_its_top_class_to_itself(workshop: Workshop, setting: str) -> None:
    workshop.link(PLAIN, Piece(having(setting), place=ASIDE)).check()


@pytest.mark.parametrize("prefix", ["part/", ""])
def test_all_kinds_at_once_in_both(workshop: Workshop, prefix: str) -> None:
    everything = having(*SETTINGS)
    reverse = having(*(setting for setting in reversed(SETTINGS) if "general" not in setting))
    if prefix:
        workshop.link(everything, Piece(reverse, place=ASIDE), Piece(PLAIN, "third/", ASIDE)).check()
    else:
        workshop.link(BASE, Piece(everything, prefix)).check()


def classed(worldbody: str, defaults: str = "") -> str:
    return f"""
    <mujoco><default><geom friction=".3"/><joint damping="3"/>{defaults}
      <default class="x"><geom rgba="1 0 0 1" friction=".6"/><joint armature=".5"/></default>
    </default><worldbody>{worldbody}</worldbody></mujoco>"""


MAIN_BY_NAME = {
    "class of an element": '<geom class="main" size="1"/><body childclass="x"><geom size="1"/>'
    '<geom size="1" class="main"/></body>',
    "childclass": '<body childclass="main"><joint/><geom size="1"/></body>',
    "childclass below another": '<body childclass="x"><geom size="1"/>'
    '<body childclass="main"><joint/><geom size="1"/></body></body>',
    "childclass of a frame": '<body childclass="x"><frame childclass="main"><geom size="1"/></frame></body>',
    "in a frame": '<frame childclass="x"><frame><geom size="1" class="main"/></frame></frame>',
    "childclass of a replicate": '<body childclass="x"><replicate count="2" childclass="main">'
    '<geom size="1"/></replicate></body>',
}


@pytest.mark.parametrize("worldbody", MAIN_BY_NAME.values(), ids=MAIN_BY_NAME.keys())
@pytest.mark.parametrize("role", ["base", "part", "part without a prefix"])
def test_the_top_class_is_found_by_its_name(workshop: Workshop, worldbody: str, role: str) -> None:
    model = classed(worldbody)
    if role == "base":
        workshop.link(model, BASE).check()
    else:
        prefix = "part/" if role == "part" else ""
        base = BASE if prefix else "<mujoco/>"
        workshop.link(base, Piece(model, prefix)).check()


OUTSIDE = """
<mujoco><default><material shininess=".1"/><equality solref=".03 1"/><tendon width=".05"/><pair condim="1"/>
  <motor gear="3"/><mesh scale="2 2 2"/>
  <default class="x"><material shininess=".9"/><equality solref=".07 1"/><tendon width=".09"/>
  <pair condim="4"/><motor gear="9"/><mesh scale="3 3 3"/></default></default>
  <asset><material name="a" class="main"/><material name="b" class="x"/><material name="c"/>
    <mesh name="a" class="main" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
    <mesh name="b" class="x" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
  <worldbody><body><joint name="j"/><geom name="g" size="1"/><geom type="mesh" mesh="a"/>
    <geom type="mesh" mesh="b"/></body><geom name="h" size="1"/></worldbody>
  <contact><pair geom1="g" geom2="h" class="main"/></contact>
  <tendon><fixed class="main"><joint joint="j" coef="1"/></fixed>
    <fixed class="x"><joint joint="j" coef="1"/></fixed></tendon>
  <equality><joint joint1="j" class="main"/><joint joint1="j" class="x"/><joint joint1="j"/></equality>
  <actuator><motor joint="j" class="main"/><motor joint="j" class="x"/><motor joint="j"/></actuator>
</mujoco>"""


def test_the_top_class_is_found_by_its_name_outside_the_body_tree(workshop: Workshop) -> None:
    workshop.link(OUTSIDE, BASE).check()
    workshop.link(BASE, OUTSIDE).check()
    workshop.link(BASE, Piece(OUTSIDE, "")).check()
    workshop.link("<mujoco/>", Piece(OUTSIDE, "a/"), Piece(OUTSIDE, "b/")).check()


SECTIONS = """
<mujoco>
  <default><geom friction=".4"/><default class="a"><geom rgba="1 0 0 1"/></default></default>
  <default><geom friction=".6"/><default class="b"><geom rgba="1 1 0 1"/></default></default>
  {more}
  <worldbody><geom size="1"/><body><geom size="1" class="a"/><geom size="1" class="b"/></body></worldbody>
</mujoco>"""
MORE_SECTIONS = [
    "",
    '<default class="main"><geom density="3"/></default>',
    "<default/>",
    '<default/><default><default class="c"><default class="d"/></default></default>',
]


@pytest.mark.parametrize("more", MORE_SECTIONS)
def test_several_sections_say_what_they_said(workshop: Workshop, more: str) -> None:
    model = SECTIONS.format(more=more)
    workshop.link(BASE, model).check()
    workshop.link(model, BASE).check()
    workshop.link(model, Piece(model), Piece(model, "b/")).check()


def test_a_class_is_a_snapshot_of_its_parent_wherever_it_is_written(workshop: Workshop) -> None:
    model = """
    <mujoco><default><default class="a"><geom rgba="1 0 0 1"/></default><geom friction=".6"/>
      <default class="b"><default class="c"><geom density="5"/></default><geom margin=".1"/></default></default>
      <worldbody><geom size="1" class="a"/><geom size="1" class="b"/><geom size="1" class="c"/></worldbody></mujoco>
    """
    workshop.link(model, BASE).check()
    workshop.link(BASE, model).check()


def test_the_tag_that_comes_last_in_a_class_still_does(workshop: Workshop) -> None:
    """All actuator tags of a class fill the same settings."""
    model = """
    <mujoco><default><position kp="50"/><motor gear="4"/>
      <default class="servo"><velocity kv="3"/><position kp="9" kv="2"/></default></default>
      <worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>
      <actuator><general joint="j"/><position joint="j"/><motor joint="j"/><general joint="j" class="servo"/>
      <velocity joint="j" class="servo"/></actuator></mujoco>"""
    workshop.link(model, BASE).check()
    workshop.link(BASE, model).check()


def test_without_top_settings_the_base_is_left_alone(workshop: Workshop) -> None:
    linked = workshop.link('<mujoco><default><default class="x"/></default><worldbody/></mujoco>', BASE)
    assert linked.linking.base_class is None
    assert "base/" not in linked.xml


def test_a_base_without_parts_keeps_its_classes(workshop: Workshop) -> None:
    linked = workshop.link(classed('<geom size="1"/>'))
    assert "base/" not in linked.xml
    linked.check()


def test_a_recipe_that_sets_the_top_class_isolates_the_base(workshop: Workshop) -> None:
    """What it sets must reach all of the base, and nothing else."""
    base = """<mujoco><asset><material name="m"/></asset>
      <worldbody><geom size="1"/><body><geom size="1"/><joint name="j"/></body></worldbody>
      <tendon><fixed><joint joint="j" coef="1"/></fixed></tendon><actuator><motor joint="j"/></actuator></mujoco>"""
    linked = workshop.link(base, BASE, isolated_tags=frozenset({"geom", "motor", "tendon"}))
    assert linked.linking.base_class == "base/"
    root = linked.linking.base.root
    for path in ("worldbody/geom", "tendon/fixed", "actuator/motor"):
        assert root.find(path).get("class") == "base/"
    assert root.find("worldbody/body").get("childclass") == "base/"
    assert root.find("asset/material").get("class") is None
    linked.check()


def test_a_part_without_a_prefix_is_wrapped_in_a_class_of_its_model(workshop: Workshop) -> None:
    part = classed('<geom size="1"/>').replace("<mujoco>", '<mujoco model="robot">')
    linked = workshop.link(BASE, Piece(part, ""))
    assert list(linked.linking.top_classes.values()) == ["robot/"]
    linked.check()


def test_two_parts_without_a_prefix_have_classes_of_their_own(workshop: Workshop) -> None:
    first = '<mujoco model="r"><default><geom friction=".1"/></default><worldbody><geom size="1"/></worldbody></mujoco>'
    second = first.replace(".1", ".2").replace('size="1"', 'size="2"')
    linked = workshop.link("<mujoco/>", Piece(first, ""), Piece(second, ""))
    assert list(linked.linking.top_classes.values()) == ["r/", "_r/"]
    assert linked.check().geom_friction[:, 0].tolist() == [0.1, 0.2]


@pytest.mark.parametrize("name", ["base/", "part/"])
def test_a_class_of_the_base_may_have_the_name_that_a_wrapped_class_would_get(workshop: Workshop, name: str) -> None:
    """A base that is itself a composition has such classes."""
    model = f"""
    <mujoco><default><geom friction=".3"/><default class="{name}"><geom friction=".6"/></default></default>
    <worldbody><geom size="1"/><geom class="{name}" size="2"/></worldbody></mujoco>"""
    part = """<mujoco><default><geom friction=".7"/></default><worldbody><body><geom size="3"/></body></worldbody>
    </mujoco>"""
    workshop.link(model, part).check()


def test_classes_of_one_name_are_told_where_nothing_keeps_them_apart(workshop: Workshop) -> None:
    fault = workshop.link(classed(""), Piece(classed(""), "")).fault
    assert fault.code == "class-clash"
    assert "`x`" in fault.message


def test_a_part_on_a_part_keeps_its_own_class(workshop: Workshop) -> None:
    arm = """<mujoco><default><geom friction=".3"/><joint damping="2"/></default>
      <worldbody><body name="link"><joint/><geom size=".1"/><site name="flange"/></body></worldbody></mujoco>"""
    hand = """<mujoco><default><joint armature=".3"/></default>
      <worldbody><body><joint/><geom size=".2"/></body><geom size=".3"/></worldbody></mujoco>"""
    workshop.link(BASE, Piece(hand, "hand/", placed("site", "arm/flange")), Piece(arm, "arm/")).check()


CLOTH = (
    '<flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" mass="1" radius=".01">'
    '<edge equality="true"/></flexcomp>'
)


@pytest.mark.parametrize(
    "worldbody", [f'<body name="holder">{CLOTH}</body>', f'<body><body name="holder">{CLOTH}</body></body>']
)
def test_joint_settings_reach_a_flex_on_a_body(workshop: Workshop, worldbody: str) -> None:
    model = f"""<mujoco><default><joint armature=".3" frictionloss=".1"/></default>
      <worldbody>{worldbody}</worldbody></mujoco>"""
    workshop.link(model, BASE).check()
    workshop.link(BASE, model).check()


MODEL = """<mujoco>{}
  <worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><position name="a" joint="j"{}/></actuator>
</mujoco>"""
EARLIER = '<default><position kp="4"/><default class="x"><velocity kv="7"/></default></default>'

# Each may find its gain in another class once the top class is wrapped, section by section.
MOVED = {
    "class of another kind": (EARLIER + '<default><velocity kv="9"/></default>', ' class="x"'),
    "class of no kind": ('<default><default class="x"/></default><default><position kp="9"/></default>', ' class="x"'),
    "class in which another kind stands before": (
        '<default><velocity kv="9"/></default><default><position kp="4"/><default class="x"><velocity/><position/></default></default>',
        ' class="x"',
    ),
    "top class of another kind": (EARLIER + '<default><velocity kv="9"/></default>', ""),
}
KEPT = {
    "class of its own kind": (
        '<default><default class="x"><position kp="5"/></default></default><default><velocity kv="9"/></default>',
        ' class="x"',
    ),
    "no actuators later": (EARLIER + '<default><geom rgba="1 0 0 1"/></default>', ' class="x"'),
    "class of the only section that sets actuators": (
        '<default><geom rgba="1 0 0 1"/></default>' + EARLIER,
        ' class="x"',
    ),
    "one section": (EARLIER, ' class="x"'),
}


LOST = EARLIER + '<default><general gainprm="9"/></default>'
"""The `<general>` gives the top class a gain that no `<position>` of a class says."""


@pytest.mark.parametrize(("defaults", "of"), MOVED.values(), ids=MOVED.keys())
def test_an_actuator_that_would_find_another_gain_says_its_own(workshop: Workshop, defaults: str, of: str) -> None:
    model = MODEL.format(defaults, of)
    workshop.link(BASE, model).check()
    workshop.link(model, Piece(model, "again/")).check()


def test_nothing_is_written_where_the_gain_is_the_same(workshop: Workshop) -> None:
    defaults = '<default><default class="x"/></default><default><position timeconst=".1"/></default>'
    model = MODEL.format(defaults, ' class="x"')
    linked = workshop.link(BASE, model)
    assert '<position name="part/a" joint="part/j" class="part/x"/>' in linked.xml
    linked.check()


@pytest.mark.mujoco4("a `<position>` keeps the gain of its class")
def test_a_gain_that_cannot_be_written_is_refused(workshop: Workshop) -> None:
    model = MODEL.format(LOST, ' class="x"')
    for fault in (workshop.link(BASE, model).fault, workshop.link(model, BASE).fault):
        assert fault.code == "not-supported"
        assert "the `<position>` `a` would take another gain" in fault.message
        assert fault.span is not None and fault.span.line == model[: model.index("<position name")].count("\n") + 1


@pytest.mark.parametrize(("defaults", "of"), KEPT.values(), ids=KEPT.keys())
def test_others_compose(workshop: Workshop, defaults: str, of: str) -> None:
    model = MODEL.format(defaults, of)
    workshop.link(BASE, model).check()
    workshop.link(model, Piece(model, "again/")).check()


@pytest.mark.parametrize(("defaults", "of"), MOVED.values(), ids=MOVED.keys())
def test_joined_sections_compose(workshop: Workshop, defaults: str, of: str) -> None:
    joined = re.sub("</default><default>(?=<position|<velocity|<general)", "", defaults)
    assert joined != defaults
    workshop.link(BASE, MODEL.format(joined, of)).check()
