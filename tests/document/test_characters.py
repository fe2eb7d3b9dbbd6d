from __future__ import annotations

import pytest

from composer.diagnostics import Sink
from composer.document import load
from composer.document.characters import check_characters


@pytest.mark.parametrize(
    ("text", "place", "character"),
    [
        (r'a: "\0"', (1, 4), "U+0000"),
        (r'"\e": 1', (1, 1), "U+001B"),
        (r'a: [1, {b: "x\uFFFE"}]', (1, 12), "U+FFFE"),
    ],
)
def test_what_xml_cannot_hold_is_refused(text: str, place: tuple[int, int], character: str) -> None:
    node = load(text, "a.yaml", Sink())
    assert node is not None
    check_characters(node, sink := Sink())
    (found,) = sink.errors
    assert found.span is not None and (found.span.line, found.span.column) == place
    assert f"the character {character}" in found.message


def test_other_escapes_are_text() -> None:
    node = load(r'a: "\t\n\r\x85 \u2028 \U0001F600"', "a.yaml", Sink())
    assert node is not None
    check_characters(node, sink := Sink())
    assert not sink.diagnostics
