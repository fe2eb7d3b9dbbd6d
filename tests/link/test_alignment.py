"""`alignfree`: the pose of free bodies in the part alone is the judge."""

from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, placed

from composer.link.part import Joint

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
    "with copies": (
        "",
        '<freejoint align="true"/><replicate count="2" offset="1 0 0"><geom size=".2"/></replicate>',
    ),
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
def test_where_a_joint_cannot_say_it_the_model_does(
    workshop: Workshop, joint: str, default: str, other: str
) -> None:
    aligned, plain = settled('alignfree="true"', joint, default), FREE.format(settings="", joint=other)
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
@pytest.mark.parametrize(
    "settings", ['settotalmass="7"', 'boundmass="1000"', 'fusestatic="true"', 'fitaabb="true"']
)
def test_what_is_measured_is_measured_in_the_frame_before_alignment(
    workshop: Workshop, joint: str, settings: str
) -> None:
    model = FREE.format(settings=f'alignfree="true" {settings}', joint=joint)
    workshop.link(BASE, model).check()
    workshop.link(model, BASE).check()


@pytest.mark.parametrize(("settings", "joint"), ALIGNED.values(), ids=ALIGNED.keys())
def test_nothing_hangs_on_what_is_aligned(workshop: Workshop, settings: str, joint: str) -> None:
    model, arm = (
        FREE.format(settings=settings, joint=joint),
        '<mujoco><worldbody><body name="arm"/></worldbody></mujoco>',
    )
    on_base = workshop.link(model, Piece(arm, "p/", placed("body", "b")))
    on_part = workshop.link(BASE, Piece(model, "p/"), Piece(arm, "q/", placed("body", "p/b")))
    for linked in (on_base, on_part):
        assert linked.fault.code == "attach-place"
        assert "MuJoCo aligns its body" in linked.fault.message


def test_what_carries_copies_of_bodies_is_not_aligned(workshop: Workshop) -> None:
    joint = '<freejoint align="true"/><replicate count="2" offset="1 0 0"><body><geom size=".2"/></body></replicate>'
    arm = '<mujoco><worldbody><body name="arm"><geom size=".1"/></body></worldbody></mujoco>'
    workshop.link(FREE.format(settings="", joint=joint), Piece(arm, "p/", placed("body", "b"))).check()
