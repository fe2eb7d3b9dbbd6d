"""`alignfree`: the pose of free bodies in the part alone is the judge.

Memory for the simulation: what a part asks for itself never takes memory from the whole model.
"""

from __future__ import annotations

import itertools

import mujoco
import pytest
from link.workshop import BASE, Piece, Workshop, placed
from mjcompose.base.diagnostic import Severity
from mjcompose.link.linking import Joint
from mjcompose.link.settings import bytes_of

FREE = """
<mujoco><compiler {settings}/><worldbody>
  <body name="b" pos="0 0 1">{joint}<geom size=".1" pos="1 0 0"/><geom type="box" size=".1 .2 .3" euler="10 20 30"/></body>
</worldbody></mujoco>"""
FREE_JOINTS = [
    "<freejoint/>",
    '<freejoint align="auto"/>',
    '<freejoint align="false"/>',
    '<freejoint align="true"/>',
    '<joint type="free"/>',
    '<joint type="free" name="j" group="2"/>',
    '<joint type="free" damping="3"/><body name="child"><geom size=".1"/></body>',
    '<joint type="free"/><replicate count="2" offset="1 0 0"><geom size=".2"/></replicate>',
    '<joint type="free"/><replicate count="2" offset="1 0 0"><body><geom size=".2"/></body></replicate>',
]
ALIGNED = {
    "freejoint": ("", '<freejoint align="true"/>'),
    "of the compiler": ('alignfree="true"', "<freejoint/>"),
    "with settings of its own": ('alignfree="true"', '<joint type="free" damping="3"/>'),
    "with copies": ("", '<freejoint align="true"/><replicate count="2" offset="1 0 0"><geom size=".2"/></replicate>'),
}


@pytest.mark.parametrize("joint", FREE_JOINTS)
@pytest.mark.parametrize("align", ["true", "false"])
def test_free_bodies_are_aligned_as_they_were(workshop: Workshop, joint: str, align: str) -> None:
    model = FREE.format(settings=f'alignfree="{align}"', joint=joint)
    workshop.link(BASE, model).check()
    workshop.link(model, FREE.format(settings="", joint="<freejoint/>")).check()


SETTLED = [
    ('<joint name="j" type="free" damping="3"/>', ""),
    ('<joint name="j" type="free"/>', '<default><joint armature="1"/></default>'),
]


def settled(settings: str, joint: str, default: str) -> str:
    return FREE.format(settings=settings, joint=joint).replace("<worldbody>", f"{default}<worldbody>")


@pytest.mark.parametrize(("joint", "default"), SETTLED)
@pytest.mark.parametrize("other", FREE_JOINTS[:6])
def test_where_a_joint_cannot_say_it_the_model_does(workshop: Workshop, joint: str, default: str, other: str) -> None:
    aligned = settled('alignfree="true"', joint, default)
    plain = FREE.format(settings="", joint=other)
    linked = workshop.link(plain, aligned)
    linked.check()
    assert 'alignfree="true"' in linked.xml
    workshop.link(aligned, plain, Piece(aligned, "b/", placed(pos=(0.0, 0.0, 5.0)))).check()


def test_a_part_that_gets_a_free_joint_is_not_aligned(workshop: Workshop) -> None:
    part = '<mujoco><worldbody><geom name="g" size=".1" pos="1 0 0"/></worldbody></mujoco>'
    joints = {"joints": (Joint("freejoint", {"name": "part/"}),)}
    composed = workshop.link(settled('alignfree="true"', *SETTLED[0]), Piece(part, options=joints)).model()
    assert composed.geom("part/g").pos.tolist() == [1, 0, 0]


def test_two_joints_that_cannot_say_it_must_agree(workshop: Workshop) -> None:
    linked = workshop.link(settled("", *SETTLED[0]), settled('alignfree="true"', *SETTLED[1]))
    fault = linked.fault
    assert fault.code == "compiler-setting"
    assert "`alignfree` of `part`" in fault.message
    assert fault.span is not None and fault.span.file == str(linked.paths[1])
    assert fault.notes[0].span is not None and fault.notes[0].span.file == str(linked.paths[0])


@pytest.mark.parametrize("joint", FREE_JOINTS[:6])
@pytest.mark.parametrize("settings", ['settotalmass="7"', 'boundmass="1000"', 'fusestatic="true"', 'fitaabb="true"'])
def test_what_is_measured_is_measured_in_the_frame_before_alignment(
    workshop: Workshop, joint: str, settings: str
) -> None:
    model = FREE.format(settings=f'alignfree="true" {settings}', joint=joint)
    workshop.link(BASE, model).check()
    workshop.link(model, BASE).check()


@pytest.mark.parametrize(("settings", "joint"), ALIGNED.values(), ids=ALIGNED.keys())
def test_nothing_hangs_on_what_is_aligned(workshop: Workshop, settings: str, joint: str) -> None:
    model = FREE.format(settings=settings, joint=joint)
    arm = '<mujoco><worldbody><body name="arm"/></worldbody></mujoco>'
    on_base = workshop.link(model, Piece(arm, "p/", placed("body", "b")))
    on_part = workshop.link(BASE, Piece(model, "p/"), Piece(arm, "q/", placed("body", "p/b")))
    for linked in (on_base, on_part):
        assert linked.fault.code == "attach-place"
        assert "MuJoCo aligns its body" in linked.fault.message


def test_what_carries_copies_of_bodies_is_not_aligned(workshop: Workshop) -> None:
    joint = '<freejoint align="true"/><replicate count="2" offset="1 0 0"><body><geom size=".2"/></body></replicate>'
    arm = '<mujoco><worldbody><body name="arm"><geom size=".1"/></body></worldbody></mujoco>'
    workshop.link(FREE.format(settings="", joint=joint), Piece(arm, "p/", placed("body", "b"))).check()


def test_a_model_alone_keeps_everything_but_its_folders(workshop: Workshop) -> None:
    settings = (
        'fusestatic="true" discardvisual="true" autolimits="false" usethread="false" inertiafromgeom="true"'
        ' alignfree="true" angle="radian" eulerseq="zyx"'
    )
    model = f'<mujoco><compiler meshdir="m" texturedir="t" strippath="true" {settings}/><worldbody/></mujoco>'
    linked = workshop.link(model)
    compiler = linked.linking.base.root.find("compiler")
    kept = " ".join(f'{name}="{value}"' for name, value in compiler.items())
    assert kept == settings
    linked.check()


def test_several_compilers_become_one_and_the_last_word_counts(workshop: Workshop) -> None:
    model = """
    <mujoco><compiler angle="radian" eulerseq="zyx"/><worldbody><body name="b" euler="1 2 3"><geom size="1"/></body></worldbody>
      <compiler angle="degree"/><compiler><lengthrange inttotal="2"/></compiler></mujoco>"""
    alone = workshop.link(model)
    assert alone.xml.count("<compiler") == 1
    assert "inttotal" in alone.xml
    alone.check()
    workshop.link(model, BASE).check()
    workshop.link(BASE, model).check()


def test_settings_without_effect_are_dropped(workshop: Workshop) -> None:
    linked = workshop.link('<mujoco><compiler usethread="false" alignfree="false"/></mujoco>', BASE)
    assert dict(linked.linking.base.root.find("compiler").attrib) == {"angle": "degree"}


def test_the_compiler_stands_first(workshop: Workshop) -> None:
    linked = workshop.link('<mujoco><worldbody/><option timestep=".01"/><compiler angle="radian"/></mujoco>', BASE)
    assert linked.linking.base.root[0].tag == "compiler"


LIMITED = """
<mujoco>
  <compiler autolimits="{auto}" angle="radian"/>
  <default><default class="k"><motor ctrlrange="-3 3" {ctrl}/><joint range="-2 1" {limited}/></default></default>
  <worldbody>
    <body>
      <joint name="h" range="-1 2" {limited}/>
      <joint name="s" type="slide" range="-1 2" {limited}/>
      <joint name="q" axis="1 0 0" actuatorfrcrange="-1 1" {jointforce}/>
      <joint name="k" axis="0 1 0" class="k"/>
      <joint name="off" axis="0 1 1" range="-1 1" limited="false"/>
      <geom size=".1"/>
      <body><joint type="ball" range="0 1" {limited}/><geom size=".1"/><site name="p"/></body>
    </body>
    <site name="w"/>
  </worldbody>
  <tendon>
    <fixed range="0 1" actuatorfrcrange="-1 1" {limited} {jointforce}><joint joint="h" coef="1"/></fixed>
    <spatial range="0 2" {limited}><site site="w"/><site site="p"/></spatial>
  </tendon>
  <actuator>
    <motor joint="h" ctrlrange="-1 1" forcerange="-2 2" {ctrl} {force}/>
    <motor joint="h" class="k"/>
    <general joint="h" dyntype="integrator" actrange="-1 1" {act}/>
    <position joint="h" inheritrange="1" {ctrl}/>
    <position joint="off" ctrlrange="-1 1" ctrllimited="false"/>
    <damper joint="h" ctrlrange="0 1"/>
  </actuator>
</mujoco>
"""
EXPLICIT = {
    "limited": 'limited="true"',
    "jointforce": 'actuatorfrclimited="true"',
    "ctrl": 'ctrllimited="true"',
    "force": 'forcelimited="true"',
    "act": 'actlimited="true"',
}


def limited(auto: str) -> str:
    return LIMITED.format(auto=auto, **(EXPLICIT if auto == "false" else dict.fromkeys(EXPLICIT, "")))


@pytest.mark.parametrize(("base", "part"), [*itertools.product(("true", "false"), repeat=2)])
def test_limits_stay_what_they_were(workshop: Workshop, base: str, part: str) -> None:
    model = workshop.link(limited(base), Piece(limited(part))).check()
    assert model.jnt_limited[: model.njnt // 2].tolist() == model.jnt_limited[model.njnt // 2 :].tolist()
    assert model.jnt_limited.sum() == 8
    assert model.actuator_ctrllimited.sum() == 8


@pytest.mark.parametrize(
    ("settings", "expected"), [(("false", "false"), "false"), (("false", "true"), None), (("true", "false"), None)]
)
def test_the_model_says_false_only_where_all_do(
    workshop: Workshop, settings: tuple[str, str], expected: str | None
) -> None:
    base, part = (f'<mujoco><compiler autolimits="{auto}"/></mujoco>' for auto in settings)
    linked = workshop.link(base, part)
    assert linked.linking.base.root.find("compiler").get("autolimits") == expected


@pytest.mark.parametrize(
    "inside",
    [
        '<worldbody><body><joint range="-1 1"/><geom size="1"/></body></worldbody>',
        '<worldbody><body><joint actuatorfrcrange="-1 1"/><geom size="1"/></body></worldbody>',
        (
            '<worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
            '<actuator><motor joint="j" ctrlrange="-1 1"/></actuator>'
        ),
        (
            '<worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
            '<tendon><fixed range="0 1"><joint joint="j" coef="1"/></fixed></tendon>'
        ),
    ],
)
def test_mujoco_refuses_a_range_that_does_not_say_whether_it_limits(inside: str) -> None:
    """On this it rests that nothing has to be written."""
    with pytest.raises(ValueError, match="autolimits"):
        mujoco.MjModel.from_xml_string(f'<mujoco><compiler autolimits="false"/>{inside}</mujoco>')


def test_a_free_joint_is_not_limited_by_a_class(workshop: Workshop) -> None:
    part = """<mujoco><compiler autolimits="false"/><worldbody>
      <body name="b"><joint type="free" range="-1 1"/><geom size="1"/></body></worldbody></mujoco>"""
    workshop.link(BASE, part).check()


def test_length_ranges_of_several_compilers_become_one(workshop: Workshop) -> None:
    model = """
    <mujoco><compiler><lengthrange mode="all"/></compiler><worldbody/>
      <compiler><lengthrange inttotal="2"/></compiler></mujoco>"""
    linked = workshop.link(model)
    (found,) = linked.linking.base.root.iter("lengthrange")
    assert dict(found.attrib) == {"mode": "all", "inttotal": "2"}
    linked.check()


MEGABYTE = 2**20


def moving(size: str, count: int = 1) -> str:
    bodies = '<body><freejoint/><geom size=".1"/></body>' * count
    return f"<mujoco>{size}<worldbody>{bodies}</worldbody></mujoco>"


def test_a_part_does_not_starve_the_whole_model(workshop: Workshop) -> None:
    base = moving("", 30)
    linked = workshop.link(base, moving('<size memory="1M"/>'))
    alone = linked.alone(0)
    whole = linked.model()
    assert whole.narena >= alone.narena > MEGABYTE
    (warning,) = linked.sink.diagnostics
    assert (warning.code, warning.severity) == ("option-conflict", Severity.WARNING)
    assert "`size.memory` of `part/` is 1M" in warning.message
    assert f"{whole.narena // MEGABYTE}M" in str(warning.help)
    assert warning.span is not None and warning.span.line == 1
    assert "<size" not in linked.xml


def test_neither_does_the_base(workshop: Workshop) -> None:
    linked = workshop.link(moving('<size memory="1M" nuserdata="3"/>'), moving("", 30))
    assert linked.model().narena > MEGABYTE
    assert "of the base is 1M" in linked.sink.diagnostics[0].message
    assert '<size nuserdata="3"/>' in linked.xml


def test_nor_two_that_say_it_both(workshop: Workshop) -> None:
    linked = workshop.link(moving('<size memory="1M"/>'), moving('<size memory="2M"/>', 30))
    assert linked.model().narena > 2 * MEGABYTE
    (warning,) = linked.sink.diagnostics
    assert [note.message for note in warning.notes] == ["`part/` requests `memory` 2M"]


@pytest.mark.parametrize("older", ["njmax", "nstack"])
def test_nor_an_older_spelling(workshop: Workshop, older: str) -> None:
    linked = workshop.link(moving("", 30), moving(f'<size {older}="10"/>'))
    assert linked.codes == ["option-conflict"]
    assert linked.model().narena >= linked.alone(0).narena


@pytest.mark.parametrize("size", ['memory="900M"', 'njmax="9000"', 'memory="-1"'])
def test_what_is_enough_for_all_stays(workshop: Workshop, size: str) -> None:
    linked = workshop.link(moving(""), moving(f"<size {size}/>"))
    assert not linked.sink.diagnostics
    assert linked.model().narena >= linked.alone(1).narena


def test_what_moves_alone_keeps_its_own(workshop: Workshop) -> None:
    linked = workshop.link(BASE, moving('<size memory="1M"/>'))
    assert not linked.sink.diagnostics
    assert linked.model().narena == MEGABYTE


def test_what_the_recipe_sets_holds(workshop: Workshop) -> None:
    """It is written after the sources have been joined."""
    linked = workshop.link(moving("", 30), moving('<size memory="1M"/>'), overridden_options=frozenset({"size/memory"}))
    assert not linked.sink.diagnostics


def test_a_model_that_does_not_compile_is_left_as_it_is(workshop: Workshop) -> None:
    broken = '<mujoco><size memory="1M"/><worldbody><body><freejoint/></body></worldbody></mujoco>'
    linked = workshop.link(moving(""), broken)
    assert not linked.sink.diagnostics
    assert 'memory="1M"' in linked.xml


@pytest.mark.parametrize(("text", "count"), [("7", 7), ("1K", 1024), (" 2m ", 2 * MEGABYTE), ("", 0)])
def test_amounts(text: str, count: float) -> None:
    assert bytes_of(text) == count
