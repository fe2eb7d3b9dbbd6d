from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, placed
from mjcompose.base.sink import Sink
from mjcompose.link.source_check import check_source, repair
from mjcompose.tree.grammar import NotMjcf
from mjcompose.tree.parse import parse_text
from mjcompose.tree.xml_text import to_text

# What the linker reads, and what may stand there instead of a number.
STUMBLING = [
    '<worldbody><body euler="1 {} 3"/></worldbody>',
    '<worldbody><body euler="1 2 3 {}"/></worldbody>',
    '<worldbody><geom axisangle="0 0 1 {}"/></worldbody>',
    '<worldbody><replicate count="2" euler="{} 0 0"/></worldbody>',
    '<worldbody><body><joint range="{} 1"/></body></worldbody>',
    '<worldbody><body><joint ref="{}"/></body></worldbody>',
    '<default><joint range="{} 1"/></default>',
    '<size nuserdata="{}"/>',
    '<size memory="{}"/>',
    '<size nkey="{}"/>',
    '<compiler inertiagrouprange="{} 3"/><worldbody><body><geom size="1"/></body></worldbody>',
    '<compiler inertiagrouprange="0 3"/><worldbody><body><geom group="{}" size="1"/></body></worldbody>',
    '<compiler inertiafromgeom="true"/><worldbody><body><inertial/><geom size="1" mass="{}"/></body></worldbody>',
    '<worldbody><body><freejoint/><geom size="1"/></body></worldbody><keyframe><key time="{}" name="k"/></keyframe>',
    '<worldbody><body><freejoint/><geom size="1"/></body></worldbody><keyframe><key qpos="1 {} 3 1 0 0 0"/></keyframe>',
    '<worldbody><body mocap="true"/></worldbody><keyframe><key mpos="1 {} 3"/></keyframe>',
    '<worldbody><replicate count="{}"><body><joint/></body></replicate></worldbody><keyframe><key/></keyframe>',
    (
        '<worldbody><body><joint name="j"/></body></worldbody>'
        '<actuator><general joint="j" dyntype="user" actdim="{}"/></actuator><keyframe><key/></keyframe>'
    ),
]
INSTEAD = ["x", "1,2", "0x", "ten", "1.0.0"]


@pytest.mark.parametrize("inside", STUMBLING)
@pytest.mark.parametrize("instead", INSTEAD)
def test_every_stumble_has_its_fault(workshop: Workshop, inside: str, instead: str) -> None:
    """Whatever a pass raises over a bad value, the value is found, and put right it raises nothing.

    What no pass reads is left to MuJoCo.
    """
    text = f"<mujoco>\n{inside.format(instead)}</mujoco>"
    radian = '<mujoco><compiler angle="radian" eulerseq="zyx"/><keyframe><key name="k" time="1"/></keyframe></mujoco>'
    for base, part in ((radian, text), (text, radian)):
        try:
            workshop.link(base, Piece(part, place=placed(pos=(1.0, 0.0, 0.0))), measure=None)
        except NotMjcf:
            sink = Sink()
            unit = parse_text(text, Sink(), file="a.xml", directory=workshop.folder, label="a")
            assert unit is not None
            assert not check_source(unit, sink)
            repair(unit)
            right = to_text(unit.root)
            again = (right, radian) if base is text else (radian, right)
            workshop.link(again[0], Piece(again[1], place=placed(pos=(1.0, 0.0, 0.0))), measure=None)
            assert all(found.span and (found.span.file, found.span.line) == ("a.xml", 2) for found in sink.errors)


def test_where_nothing_is_wrong_nothing_is_told(workshop: Workshop) -> None:
    sink = Sink()
    unit = workshop.unit(BASE)
    assert check_source(unit, sink)
    assert not sink.diagnostics


def test_all_bad_values_are_told_at_once(workshop: Workshop) -> None:
    sink = Sink()
    units = [
        workshop.unit('<mujoco><worldbody><body euler="a b c"/></worldbody></mujoco>'),
        workshop.unit('<mujoco><worldbody><geom type="ball"/><light active="maybe"/></worldbody></mujoco>'),
    ]
    for unit in units:
        assert not check_source(unit, sink)
    assert sorted(found.code for found in sink.errors) == ["wrong-keyword", "wrong-type", "wrong-type"]


@pytest.mark.parametrize(
    ("inside", "code", "message"),
    [
        ("<option><headlight/></option>", "unknown-element", "`<headlight>` cannot be in `<option>`"),
        ('<contact internal="1"/>', "unknown-attribute", "`internal` is not an attribute of `<contact>`"),
        ('<default><joint nrow="3"/></default>', "unknown-attribute", "`nrow` is not an attribute of `<joint>`"),
        ('<compiler angle="1e"/>', "wrong-keyword", "`angle` of `<compiler>` expects `radian` or `degree`, got `1e`"),
        (
            "<visual><global/><global/></visual>",
            "wrong-length",
            "MuJoCo takes one `<global>` in `<visual>`, and this is another one",
        ),
        (
            '<worldbody><body name="world"/></worldbody>',
            "bad-name",
            "a body cannot be called `world`, which is the name of the world itself",
        ),
        ('<default class="hand"/>', "bad-name", "a default class at the top must be called `main`, got `hand`"),
        ("<default><default/></default>", "bad-name", "a default class inside another has no name"),
        ('<default><default class="main"/></default>', "class-clash", "two classes are called `main`"),
        (
            '<default><default class="a"><default class="a"/></default></default>',
            "class-clash",
            "two classes are called `a`",
        ),
        ('<size njmax=" "/>', "wrong-type", "`njmax` of `<size>` is empty"),
        (
            '<keyframe><key name="a"/></keyframe><keyframe><key name="a"/></keyframe>',
            "name-clash",
            "two keys are called `a`",
        ),
        (
            '<worldbody><geom mode="x" size="1"/></worldbody>',
            "unknown-attribute",
            "`mode` is not an attribute of `<geom>`",
        ),
        ("<worldbody><frame><bone/></frame></worldbody>", "unknown-element", "`<bone>` cannot be in `<frame>`"),
    ],
)
def test_what_would_get_lost_is_told(workshop: Workshop, inside: str, code: str, message: str) -> None:
    sink = Sink()
    unit = workshop.unit(f"<mujoco>{inside}</mujoco>")
    assert not check_source(unit, sink)
    assert [(each.code, each.message) for each in sink.errors] == [(code, message)]
    repair(unit)
    assert check_source(unit, sink)


def test_what_mujoco_passes_over_in_the_file_itself_is_no_fault(workshop: Workshop) -> None:
    unit = workshop.unit(
        '<mujoco><worldbody><frame><geom mode="x" size="1"><bone/></geom></frame></worldbody></mujoco>'
    )
    assert check_source(unit, Sink())


@pytest.mark.parametrize(
    ("element", "names"),
    [
        ('<inertial mass="1" pos="0 0 0" fullinertia="1 1 1 0 0 0" quat="1 0 0 0"/>', "`fullinertia` and `quat`"),
        ('<camera resolution="9 9" fovy="40" sensorsize="1 1"/>', "`fovy` and `sensorsize`"),
        ('<light directional="true" type="spot"/>', "`directional` and `type`"),
    ],
)
def test_attributes_of_which_mujoco_takes_one(workshop: Workshop, element: str, names: str) -> None:
    """MuJoCo 3.12 to 4.0 looks at them outside of frames alone."""
    sink = Sink()
    text = "<mujoco><worldbody>{}</worldbody></mujoco>"
    unit = workshop.unit(text.format(f"<body>{element}</body>"))
    assert not check_source(unit, sink)
    (error,) = sink.errors
    assert error.message.endswith(f"has {names}, and MuJoCo takes only one of them")
    repair(unit)
    assert check_source(unit, sink)
    assert check_source(workshop.unit(text.format(f"<frame><body>{element}</body></frame>")), sink)


def test_sections_may_be_written_several_times(workshop: Workshop) -> None:
    unit = workshop.unit("<mujoco><option/><option/><default/><default/></mujoco>")
    assert check_source(unit, Sink())


def test_attributes_that_a_newer_mujoco_may_have_are_left_to_it(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mjcompose.link.source_check._installed", lambda: (99,))
    assert check_source(workshop.unit('<mujoco><option gravitas="1"/></mujoco>'), Sink())
