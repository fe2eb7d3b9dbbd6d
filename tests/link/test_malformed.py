from __future__ import annotations

from pathlib import Path

from composer.diagnostics import Sink
from composer.link.malformed import malformed
from composer.tree.parse import parse_text
from composer.tree.unit import Unit


def unit(text: str, file: str) -> Unit:
    found = parse_text(text, Sink(), file=file, directory=Path(), label="a")
    assert found is not None
    return found


def test_every_value_that_cannot_be_read(tmp_path: Path) -> None:
    one = unit(
        '<mujoco>\n<worldbody>\n<body pos="0 0 x"><joint range="1"/></body>\n</worldbody>\n</mujoco>',
        "one.xml",
    )
    two = unit(
        '<mujoco>\n<option timestep="a" cone="round"/>\n<keyframe>\n<key qpos="1 b"/>\n</keyframe>\n</mujoco>',
        "two.xml",
    )
    sink = Sink()
    assert malformed([one, two], sink)
    assert [(str(each.span), each.code) for each in sink.sorted()] == [
        ("one.xml:3:12", "wrong-type"),
        ("one.xml:3:33", "wrong-type"),
        ("two.xml:2:19", "wrong-type"),
        ("two.xml:2:28", "wrong-keyword"),
        ("two.xml:4:12", "wrong-type"),
    ]


def test_nothing_where_all_is_well() -> None:
    sink = Sink()
    text = '<mujoco unheard="of"><worldbody><body pos="0 0 0x1p3" euler=""><what x="y"/></body></worldbody></mujoco>'
    assert not malformed([unit(text, "one.xml")], sink)
    assert sink.diagnostics == []
