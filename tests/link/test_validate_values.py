from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, placed

from composer.diagnostics.sink import Sink
from composer.link.validate_values import STUMBLES, malformed, put_right
from composer.tree.parse import parse_text
from composer.tree.write import to_text

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
        except STUMBLES:
            sink = Sink()
            unit = parse_text(text, Sink(), file="a.xml", directory=workshop.folder, label="a")
            assert unit is not None
            assert malformed([unit], sink)
            put_right(unit)
            right = to_text(unit.root)
            again = (right, radian) if base is text else (radian, right)
            workshop.link(again[0], Piece(again[1], place=placed(pos=(1.0, 0.0, 0.0))), measure=None)
            assert all(
                found.span and (found.span.file, found.span.line) == ("a.xml", 2) for found in sink.errors
            )


def test_where_nothing_is_wrong_nothing_is_told(workshop: Workshop) -> None:
    sink = Sink()
    unit = workshop.unit(BASE)
    assert not malformed([unit], sink)
    assert not sink.diagnostics


def test_all_bad_values_are_told_at_once(workshop: Workshop) -> None:
    sink = Sink()
    units = [
        workshop.unit('<mujoco><worldbody><body euler="a b c"/></worldbody></mujoco>'),
        workshop.unit('<mujoco><worldbody><geom type="ball"/><light active="maybe"/></worldbody></mujoco>'),
    ]
    assert malformed(units, sink)
    assert sorted(found.code for found in sink.errors) == ["wrong-keyword", "wrong-type", "wrong-type"]
