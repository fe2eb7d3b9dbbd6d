from __future__ import annotations

from pathlib import Path

import pytest

from composer.diagnostics import Diagnostic, Sink
from composer.tree.parse import parse_text


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
        (
            "version https://git-lfs.github.com/spec/v1\nsize 1\n",
            "it is not the file itself but where Git LFS has it",
        ),
        ("<mujoco>\n<body>\n</mujoco>", "`</mujoco>` stands where `<body>` is still open"),
        ("<mujoco>\n<body>\n</body>\n", "`<mujoco>` is never closed"),
        ("<mujoco>\n<body\n<geom/></mujoco>", "a tag is not ended before the next one begins"),
        ('<mujoco><body name="a></mujoco>', "a `<` stands in the value of an attribute"),
        ("<mujoco><body name=a/></mujoco>", "the value of an attribute has no quotes"),
        ("<mujoco><body name/></mujoco>", "the attribute `name` has no value"),
        ("<mujoco><body a='1' a='2'/></mujoco>", "the attribute `a` is written twice in one tag"),
        ("<mujoco model='a & b'/>", "a `&` stands by itself"),
        ("<mujoco model='a &b c'/>", "a `&` stands by itself"),
        ("<mujoco><!-- a </mujoco>", "a comment is never closed"),
        ("<mujoco/><mujoco/>", "something stands after the end of its one outermost element"),
        ("<mujoco>1 < 2</mujoco>", "a `<` begins no tag"),
        ("<mujoco><![CDATA[</mujoco>", "a `<![CDATA[` is never closed"),
        ("<mujoco></mujoco a='1'>", "a tag lacks its `>`"),
        ("<mujoco>&#0;</mujoco>", "a character stands there that XML cannot hold"),
        ("<mujoco a='\x01'/>", "a character stands there that XML cannot hold"),
        (b"<mujoco model='\xe9'/>", "it is not UTF-8 text, and does not say what else"),
    ],
)
def test_in_plain_words(text: str | bytes, said: str) -> None:
    assert fault(text).message == f"`a.xml` is not XML: {said}"


def test_the_open_tag_is_shown() -> None:
    found = fault("<mujoco>\n  <body>\n    <geom size='1'>\n  </body>\n</mujoco>\n")
    assert (found.span and found.span.line, found.help) == (
        4,
        "end the tag with `/>`, or write `</geom>` first",
    )
    (note,) = found.notes
    assert note.message == "`<geom>` begins here"
    assert note.span and (note.span.line, note.span.column, note.span.end_column) == (3, 5, 10)


def test_words_that_are_not_known_are_passed_on_in_lower_case() -> None:
    assert fault("<a>]]></a>").message == "`a.xml` is not XML: sequence ']]>' not allowed in content"
