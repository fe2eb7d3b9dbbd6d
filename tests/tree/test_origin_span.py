from __future__ import annotations

from pathlib import Path

from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.tree.parse import parse_file, parse_text
from mjcompose.tree.unit import FileText, Origins

TEXT = '<mujoco>\n  <worldbody>\n    <geom\n      name="ball"\n      size="1"/>\n  </worldbody>\n</mujoco>\n'


def test_the_start_tag_and_the_attribute(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(TEXT)
    unit = parse_file(tmp_path / "a.xml", Sink(), file="a.xml")
    assert unit is not None
    geom = unit.root[0][0]
    assert unit.origins.span(geom, unit.file) == Span("a.xml", 3, 5, 3, 10)
    assert unit.origins.span(geom, unit.file, "size") == Span("a.xml", 5, 13, 5, 14)
    assert unit.origins.span(geom, unit.file, "size", key=True) == Span("a.xml", 5, 7, 5, 11)
    assert unit.origins.span(geom, unit.file, "rgba") == Span("a.xml", 3, 5, 3, 10), "it is not written"


def test_after_renaming_moving_and_copying() -> None:
    unit = parse_text(TEXT, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    copied = unit.copied()
    geom = copied.root[0][0]
    geom.set("name", "left/ball")
    other = parse_text("<mujoco/>", Sink(), file="b.xml", directory=Path(), label="b")
    assert other is not None
    other.root.append(geom)
    other.origins.adopt(copied.origins)
    other.origins.own(geom, copied.file)
    assert other.origins.span(geom, other.file, "name") == Span("a.xml", 4, 13, 4, 17)


def test_the_nearest_owner_counts() -> None:
    unit = parse_text(TEXT, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    here = Span("recipe.yaml", 7, 1)
    unit.origins.own(unit.root[0], here)
    assert unit.origins.span(unit.root[0][0], unit.file) == here
    unit.origins.own(unit.root[0][0], lambda attribute: Span("recipe.yaml", 9 if attribute == "size" else 8, 1))
    assert unit.origins.span(unit.root[0][0], unit.file).line == 8
    assert unit.origins.span(unit.root[0][0], unit.file, "size").line == 9


def test_without_a_text_the_line_remains(tmp_path: Path) -> None:
    unit = parse_text(TEXT, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    geom = unit.root[0][0]
    assert Origins().span(geom, "a.xml") == Span("a.xml", 5, 1)
    assert Origins(texts={"a.xml": FileText(tmp_path / "gone.xml")}).span(geom, "a.xml") == Span("a.xml", 5, 1)
    assert Origins(texts={"a.xml": FileText(contents="<other/>")}).span(geom, "a.xml") == Span("a.xml", 5, 1)
    assert Origins().span(unit.root.makeelement("geom"), "a.xml") == Span("a.xml", 1, 1)


def test_lines_stay_what_they_are_where_the_text_is_mended() -> None:
    """MuJoCo reads comments with `--` in them and files that begin with an empty line."""
    text = "\n\n<?xml version='1.0'?>\n<!-- -- -->\n" + TEXT
    unit = parse_text(text, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    assert unit.origins.span(unit.root[1][0], unit.file) == Span("a.xml", 7, 5, 7, 10)


def test_what_a_program_has_set_is_on_its_line() -> None:
    unit = parse_text(TEXT, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    geom = unit.root[0][0]
    line = Span("program.py", 7, 1)
    unit.origins.settings[geom] = {"size": line}
    copied = unit.copied()
    for one in (unit, copied):
        assert one.origins.span(one.root[0][0], one.file, "size") == line
        assert one.origins.span(one.root[0][0], one.file, "name") == Span("a.xml", 4, 13, 4, 17)
