from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from lxml import etree
from mjcompose.base.diagnostic import Diagnostic, Severity
from mjcompose.base.sink import Sink
from mjcompose.tree.parse import parse_file, parse_text
from mjcompose.tree.xml_faults import ignored, is_unread_alone, unread


def found(inside: str) -> list[tuple[str, str | None]]:
    root = etree.fromstring(f"<mujoco><worldbody>{inside}</worldbody></mujoco>")
    return [(str(element.tag), name) for element, name in unread(root)]


def test_below_frames_and_replicates() -> None:
    assert found('<frame><geom siz="1" size="1"/></frame>') == [("geom", "siz")]
    assert found('<body><frame x="1"><body><geom/><joint rang="1"/></body></frame></body>') == [
        ("frame", "x"),
        ("joint", "rang"),
    ]
    assert found('<replicate count="2"><site color="1"/></replicate>') == [("site", "color")]


def test_nothing_where_mujoco_looks_itself() -> None:
    assert found('<geom siz="1"/><body odd="1"><geom siz="1"/></body>') == []
    assert found('<frame><unheard_of x="1"/></frame>') == []
    assert (
        found('<frame name="f" pos="0 0 1" childclass="c"><body mocap="true"><geom fitscale="1"/></body></frame>') == []
    )


@pytest.mark.parametrize("holder", ["frame", 'replicate count="2"'])
def test_mujoco_does_not_look_there(holder: str) -> None:
    """The reason for all this; the day it looks, this can go."""
    inside = f'<{holder}><geom size="1" color="1"/></{holder.split()[0]}>'
    assert mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{inside}</worldbody></mujoco>").ngeom > 0


def test_elements_in_what_can_have_none() -> None:
    assert found('<frame><geom size="1"><note/></geom></frame>') == [("note", None)]
    assert found('<geom size="1"><note/></geom>') == []  # which MuJoCo refuses


@pytest.mark.parametrize("inside", ["<geom size='1'><note/></geom>", "<body><geom size='1' odd='1'/></body>"])
def test_mujoco_refuses_without_a_frame_what_it_passes_over_below(inside: str) -> None:
    assert mujoco.MjModel.from_xml_string(f"<mujoco><worldbody><frame>{inside}</frame></worldbody></mujoco>").ngeom == 1
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
    assert [(each.code, each.severity) for each in sink.diagnostics] == [("unknown-element", Severity.WARNING)]
    assert parse_text(model.format(""), sink, file="m.xml", directory=tmp_path, label="m") is None


def fault(text: str | bytes) -> Diagnostic:
    sink = Sink()
    assert parse_text(text, sink, file="a.xml", directory=Path(), label="a") is None
    (found,) = sink.diagnostics
    assert found.code == "xml-syntax" and found.message.startswith("`a.xml` is not XML: ")
    return found


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "it is empty"),
        ("hello", "it does not begin with `<`"),
        ("version https://git-lfs.github.com/spec/v1\nsize 1\n", "it is a pointer of Git LFS, not the file itself"),
        ("<mujoco>\n<body>\n</mujoco>", "`</mujoco>` closes a tag, but `<body>` is still open"),
        ("<mujoco>\n<body>\n</body>\n", "`<mujoco>` is never closed"),
        ("<mujoco>\n<body\n<geom/></mujoco>", "a tag does not end before the next tag begins"),
        ('<mujoco><body name="a></mujoco>', "the value of an attribute has a `<`"),
        ("<mujoco><body name=a/></mujoco>", "the value of an attribute has no quotes"),
        ("<mujoco><body name/></mujoco>", "the attribute `name` has no value"),
        ("<mujoco><body a='1' a='2'/></mujoco>", "the attribute `a` appears twice in a tag"),
        ("<mujoco model='a & b'/>", "a `&` appears by itself"),
        ("<mujoco model='a &b c'/>", "a `&` appears by itself"),
        ("<mujoco><!-- a </mujoco>", "a comment is never closed"),
        ("<mujoco/><mujoco/>", "something follows the end of its outermost element"),
        ("<mujoco>1 < 2</mujoco>", "a `<` begins no tag"),
        ("<mujoco><![CDATA[</mujoco>", "a `<![CDATA[` is never closed"),
        ("<mujoco></mujoco a='1'>", "a tag lacks its `>`"),
        ("<mujoco>&#0;</mujoco>", "it has a character that XML cannot hold"),
        ("<mujoco a='\x01'/>", "it has a character that XML cannot hold"),
        (b"<mujoco model='\xe9'/>", "it is not UTF-8 text, and names no other encoding"),
    ],
)
def test_in_plain_words(text: str | bytes, said: str) -> None:
    assert fault(text).message == f"`a.xml` is not XML: {said}"


def test_the_open_tag_is_shown() -> None:
    found = fault("<mujoco>\n  <body>\n    <geom size='1'>\n  </body>\n</mujoco>\n")
    assert (found.span and found.span.line, found.help) == (4, "end the tag with `/>`, or write `</geom>` first")
    (note,) = found.notes
    assert note.message == "`<geom>` begins here"
    assert note.span and (note.span.line, note.span.column, note.span.end_column) == (3, 5, 10)


def test_words_that_are_not_known_are_passed_on_in_lower_case() -> None:
    assert fault("<a>]]></a>").message == "`a.xml` is not XML: sequence ']]>' not allowed in content"
