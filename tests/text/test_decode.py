from __future__ import annotations

import codecs

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mjcompose.base.diagnostic import Span
from mjcompose.base.limits import allow
from mjcompose.base.sink import Sink
from mjcompose.text.decode import Mask, decode, position


def test_text_and_bytes_without_their_mark() -> None:
    sink = Sink()
    assert decode("\ufeffa: ü", "f", sink) == "a: ü"
    assert decode(codecs.BOM_UTF8 + "a: ü\t\r\n\x85\U0001f600".encode(), "f", sink) == "a: ü\t\r\n\x85\U0001f600"
    assert sink.diagnostics == []


@pytest.mark.parametrize(
    ("source", "line", "column"),
    [(b"\xff", 1, 1), (b"a: 1\r\n\xc3\xa4\xe4", 2, 2), (codecs.BOM_UTF8 + b"ab\xc3", 1, 3), (b"a\rb\x80", 2, 2)],
)
def test_bytes_that_are_not_utf_8_are_located(source: bytes, line: int, column: int) -> None:
    sink = Sink()
    assert decode(source, "f", sink) is None
    assert [each.code for each in sink.diagnostics] == ["yaml-not-utf8"]
    assert sink.diagnostics[0].span == Span("f", line, column, line, column + 1)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-32"])
def test_other_encodings_are_named(encoding: str) -> None:
    mark = codecs.BOM_UTF16_BE if encoding == "utf-16-be" else b""
    sink = Sink()
    assert decode(mark + "a: 1".encode(encoding), "f", sink) is None
    assert f"{encoding[:6].upper()} text" in sink.diagnostics[0].message


@pytest.mark.parametrize("character", ["\0", "\x1b", "\x7f", "\x9f", "\ufffe", "\ud800"])
def test_control_characters_are_located_and_counted(character: str) -> None:
    sink = Sink()
    assert decode(f"a: 1\nb: {character}{character}", "f", sink) is None
    (found,) = sink.diagnostics
    assert found.span == Span("f", 2, 4, 2, 5)
    assert f"U+{ord(character):04X}" in found.message
    assert "1 more" in found.notes[0].message


@allow(recipe_size=10)
def test_too_large() -> None:
    for source in ("x" * 11, b"x" * 11):
        sink = Sink()
        assert decode(source, "f", sink) is None
        assert [each.code for each in sink.diagnostics] == ["yaml-too-large"]
    assert decode("x" * 10, "f", Sink()) == "x" * 10


def test_position_knows_all_line_breaks() -> None:
    text = "a\nbc\r\nd\re\u2028f"
    assert [position(text, text.index(c)) for c in "abcdef"] == [(1, 1), (2, 1), (2, 2), (3, 1), (4, 1), (4, 3)]
    assert position(text, len(text)) == (4, 4)
    assert position("", 0) == (1, 1)
    assert position("a\n", 2) == (2, 1)


@settings(deadline=None)
@given(st.text(st.sampled_from("ab${}[]*, \n\x85\u2028\ue000\ue001")), st.integers(0, 20), st.integers(0, 20))
def test_positions_stay_and_restoring_undoes(text: str, start: int, length: int) -> None:
    mask = Mask(text)
    mask.hide(start, start + length)
    assert len(mask.text) == len(text)
    assert mask.restore(mask.text) == text
    assert not set("${}[]*,") & set(mask.text[start : start + length]) - {"$"}
    assert not set("\x85\u2028") & set(mask.text)


def test_hiding_what_is_harmless_changes_nothing() -> None:
    mask = Mask("abc")
    assert not mask.hide(0, 3)
    assert not mask.active
    assert Mask("a*c").hide(0, 3)


def test_stand_ins_are_not_written_as_escapes_either() -> None:
    mask = Mask("a*\n" + r'"\ue000 \uE001"')
    assert mask.hide(0, 2)
    assert mask.text[1] == "\ue002"


def test_without_anything_left_to_stand_in() -> None:
    text = "*\u2028" + "".join(map(chr, range(0xE000, 0xF900)))
    mask = Mask(text)
    assert not mask.hide(0, 1)
    assert mask.text == text
