"""Columns in the units of the protocol, and lines that editors and YAML count alike."""

from __future__ import annotations

import pytest
from mjcompose.lsp.analysis import column_of, moved, units
from mjcompose.text.node import lines_of

LINE = "a🤖é\u2028: x"


@pytest.mark.parametrize(("encoding", "name"), [("utf-8", "utf-8"), ("utf-16", "utf-16-le"), ("utf-32", "utf-32-le")])
def test_units_are_those_of_the_encoding(encoding: str, name: str) -> None:
    size = {"utf-8": 1, "utf-16": 2, "utf-32": 4}[encoding]
    for column in range(len(LINE) + 1):
        expected = len(LINE[:column].encode(name)) // size
        assert units(LINE, column, encoding) == expected
        assert column_of(LINE, expected, encoding) == column


def test_a_column_behind_the_end_is_the_end() -> None:
    assert column_of("ab", 7) == 2
    assert units("ab", 7) == 2


def test_every_line_break_of_the_protocol_counts_and_no_other() -> None:
    assert lines_of("a\rb\r\nc\nd\x85e\u2028f\x0b") == ["a", "b", "c", "d\x85e\u2028f\x0b"]


def test_lines_that_have_not_changed_are_found_again() -> None:
    assert moved(list("abc"), list("axbc")) == {0: 0, 1: 2, 2: 3}
    assert moved(list("abc"), []) == {}
    assert moved(list("aaa"), list("aa")) == {0: 0, 1: 1}
