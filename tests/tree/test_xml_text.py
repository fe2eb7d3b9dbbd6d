from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.tree.parse import parse_file, parse_text
from mjcompose.tree.xml_text import SourceText, Stretch, to_text


def _written(custom: str) -> str:
    sink = Sink()
    text = f"<mujoco><custom>{custom}</custom></mujoco>"
    unit = parse_text(text, sink, file="m.xml", directory=Path(), label="m")
    assert unit is not None and not sink.has_errors
    return to_text(unit.root)


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ('<text name="i"><![CDATA[a "q" & <b>]]></text>', b'a "q" & <b>\0'),
        ('<text name="i">\n <![CDATA[a\nb]]> c</text>', b"a\nb\0"),
        ('<!-- <![CDATA[ --><text name="z" data="z"/><text name="i"><![CDATA[a]]></text>', b"z\0a\0"),
    ],
)
def test_a_section_is_the_data_of_a_text(text: str, data: bytes) -> None:
    assert mujoco.MjModel.from_xml_string(_written(text)).text_data == data


def test_plain_text_means_nothing() -> None:
    assert "data" not in _written('<text name="i">plain</text><!-- <![CDATA[x]]> -->')


def test_what_mujoco_saves_comes_back(tmp_path: Path) -> None:
    spec = mujoco.MjSpec()
    spec.add_text(name="i", data='say "hello"')
    spec.compile()
    (tmp_path / "inner.xml").write_text(spec.to_xml())
    (tmp_path / "m.xml").write_text('<mujoco><include file="inner.xml"/></mujoco>')
    unit = parse_file(tmp_path / "m.xml", Sink())
    assert unit is not None
    assert mujoco.MjModel.from_xml_string(to_text(unit.root)).text_data == b'say "hello"\0'


TEXT = """\
<mujoco>
  <!-- <geom name="not this one"/> --> <geom name="a"/> <geom name="b"
  /><geomx name="x"/>
  <geom
      name="c"
      size='1 2
            3' pos = "0 0 0"
  />
  <body name="d"><geom name="e" class="1 &gt; 0"/></body>
</mujoco>
"""


def of(text: str, name: str) -> tuple[SourceText, str, int, dict[str, str]]:
    """What is asked of the text for the element of that name: its tag, lxml's line and its attributes."""
    element = next(each for each in etree.fromstring(text).iter() if each.get("name") == name)
    return SourceText(text), str(element.tag), element.sourceline, dict(element.items())


def test_where_start_tags_begin() -> None:
    for name, expected in (
        ("a", Stretch(2, 40, 45)),
        ("b", Stretch(2, 57, 62)),
        ("x", Stretch(3, 5, 11)),
        ("c", Stretch(4, 3, 8)),
        ("d", Stretch(9, 3, 8)),
        ("e", Stretch(9, 18, 23)),
    ):
        text, tag, line, attributes = of(TEXT, name)
        assert text.element(tag, line, attributes) == expected, name


def test_values_and_names_of_attributes() -> None:
    text, tag, line, attributes = of(TEXT, "c")
    assert text.attribute(tag, line, attributes, "name") == Stretch(5, 13, 14)
    assert text.attribute(tag, line, attributes, "pos") == Stretch(7, 23, 28)
    assert text.attribute(tag, line, attributes, "pos", key=True) == Stretch(7, 16, 19)
    assert text.attribute(tag, line, attributes, "size") is None, "it is written on two lines"
    assert text.attribute(tag, line, attributes, "rgba") is None
    text, tag, line, attributes = of(TEXT, "e")
    assert text.attribute(tag, line, attributes, "class") == Stretch(9, 40, 48)


def test_the_tag_whose_attributes_fit_best() -> None:
    text = SourceText('<a><b name="x" size="1"/><b name="y" size="1"/><b size="1"/></a>')
    assert text.element("b", 1, {"name": "left/y", "size": "1"}) == Stretch(1, 26, 28)
    assert text.element("b", 1, {"name": "x", "size": "2", "pos": "0"}) == Stretch(1, 4, 6)
    assert text.element("b", 1, {"size": "1"}) == Stretch(1, 48, 50)


def test_nothing_where_there_is_no_such_tag() -> None:
    text = SourceText("<a>\n  <b/>\n</a>")
    assert text.element("b", 1, {}) is None
    assert text.element("c", 2, {}) is None
    assert text.element("b", 0, {}) is None and text.element("b", 99, {}) is None
    assert SourceText("").element("b", 1, {}) is None


def test_line_breaks_and_encodings() -> None:
    for data in (
        b"\xef\xbb\xbf<a>\r\n  <b c='1'/>\r\n</a>",
        "<a>\r  <b c='1'/>\r</a>",
        '<?xml version="1.0" encoding="utf-16"?><a>\n  <b c=\'1\'/>\n</a>'.encode("utf-16"),
        b"<a caf\xe9=''>\n  <b c='1'/>\n</a>",
    ):
        assert SourceText(data).attribute("b", 2, {"c": "1"}, "c") == Stretch(2, 9, 10)


def test_every_element_of_a_real_file_is_found() -> None:
    """Whatever the layout: the tag that is found for lxml's line is that of the element."""
    indented = TEXT.replace(' name="', '\n\n      name="').replace("/>", "\n  />")
    for text in (TEXT, indented, TEXT.replace("\n", "\r\n")):
        source = SourceText(text)
        plain = text.replace("\r\n", "\n").split("\n")
        for element in etree.fromstring(text.encode()).iter("*"):
            found = source.element(str(element.tag), element.sourceline, dict(element.items()))
            assert found is not None
            line = plain[found.line - 1]
            assert line[found.column - 1 : found.end_column - 1] == f"<{element.tag}"


def test_of_many_on_one_line_each_is_found_at_once() -> None:
    written = [f'<geom name="g{number}"/>' for number in range(5000)]
    text = SourceText("".join(written))
    found = []
    compared = text._likeness
    text._likeness = lambda *given: found.append(given) or compared(*given)  # type: ignore[method-assign,func-returns-value]
    column = sum(map(len, written[:-1])) + 1
    assert text.element("geom", 1, {"name": "g4999"}) == (1, column, column + 5)
    assert text.element("geom", 1, {"name": "g0"}) == (1, 1, 6) and found == []
    assert text.element("geom", 1, {"name": "part/g1"}) == (1, 18, 23) and found
