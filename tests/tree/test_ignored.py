from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from lxml import etree

from composer.diagnostics.diagnostic import Severity
from composer.diagnostics.sink import Sink
from composer.tree.ignored import ignored, is_unread_alone, unread
from composer.tree.parse import parse_file, parse_text


def found(inside: str) -> list[tuple[str, str | None]]:
    root = etree.fromstring(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")
    return [(str(element.tag), name) for element, name in unread(root)]


def test_below_frames_and_replicates() -> None:
    assert found('<frame><geom siz="1" size="1"/></frame>') == [("geom", "siz")]
    assert found('<body><frame x="1"><body><geom/><joint rang="1"/></body></frame></body>') == [
        ("frame", "x"),
        ("joint", "rang"),
    ]
    assert found('<replicate count="2"><site colour="1"/></replicate>') == [("site", "colour")]


def test_nothing_where_mujoco_looks_itself() -> None:
    assert found('<geom siz="1"/><body odd="1"><geom siz="1"/></body>') == []
    assert found('<frame><unheard_of x="1"/></frame>') == []
    assert (
        found(
            '<frame name="f" pos="0 0 1" childclass="c"><body mocap="true"><geom fitscale="1"/></body></frame>'
        )
        == []
    )


@pytest.mark.parametrize("holder", ["frame", 'replicate count="2"'])
def test_mujoco_does_not_look_there(holder: str) -> None:
    """The reason for all this; the day it looks, this can go."""
    inside = f'<{holder}><geom size="1" colour="1"/></{holder.split()[0]}>'
    assert mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{inside}</worldbody></mujoco>").ngeom > 0


def test_elements_in_what_can_have_none() -> None:
    assert found('<frame><geom size="1"><note/></geom></frame>') == [("note", None)]
    assert found('<geom size="1"><note/></geom>') == []  # which MuJoCo refuses


@pytest.mark.parametrize("inside", ["<geom size='1'><note/></geom>", "<body><geom size='1' odd='1'/></body>"])
def test_mujoco_refuses_without_a_frame_what_it_passes_over_below(inside: str) -> None:
    assert (
        mujoco.MjModel.from_xml_string(
            f"<mujoco><worldbody><frame>{inside}</frame></worldbody></mujoco>"
        ).ngeom
        == 1
    )
    with pytest.raises(ValueError, match="unrecognized"):
        mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")


def test_what_this_version_does_not_have_is_passed_over_too() -> None:
    """The grammar and MuJoCo agree on each attribute of each element of the body tree."""
    root = etree.fromstring(
        '<mujoco><worldbody><frame><flexcomp><contact internal="true" margin="0"/></flexcomp></frame></worldbody></mujoco>'
    )
    contact = root.find(".//contact")
    assert [*unread(root, "4.0.0")] == [(contact, "internal")] == [*unread(root)]
    assert [*unread(root, "3.12.0")] == []


def test_a_source_remembers_it_through_copies_and_includes(tmp_path: Path) -> None:
    (tmp_path / "rod.xml").write_text('<mujocoinclude>\n<geom name="rod" size="1" odd="1"/></mujocoinclude>')
    (tmp_path / "m.xml").write_text(
        '<mujoco><worldbody><frame><include file="rod.xml"/></frame><geom size="1" odd="1"/></worldbody></mujoco>'
    )
    unit = parse_file(tmp_path / "m.xml", Sink(), file="m.xml")
    assert unit is not None
    for each in (unit, unit.copied()):
        below, beside = each.root.iter("geom")
        assert is_unread_alone(below, "odd", each) and not is_unread_alone(beside, "odd", each)
        told = ignored(below, "odd", each)
        assert told.message == "MuJoCo ignores `odd` of `<geom>`, which means nothing"
        assert told.span is not None and (told.span.line, told.span.column) == (2, 27)


def test_a_body_beside_the_world_is_not_part_of_the_model(tmp_path: Path) -> None:
    model = '<mujoco><body name="lost"><geom size="1"/></body><worldbody>{}</worldbody></mujoco>'
    assert mujoco.MjModel.from_xml_string(model.format('<geom size="1"/>')).nbody == 1
    sink = Sink()
    unit = parse_text(model.format('<geom size="1"/>'), sink, file="m.xml", directory=tmp_path, label="m")
    assert unit is not None and unit.root.find("body") is None
    assert [(each.code, each.severity) for each in sink.diagnostics] == [
        ("unknown-element", Severity.WARNING)
    ]
    assert parse_text(model.format(""), sink, file="m.xml", directory=tmp_path, label="m") is None
