from __future__ import annotations

import pytest

from composer.diagnostics import Sink
from composer.document.load import load


@pytest.mark.parametrize(
    ("text", "column", "help"),
    [
        ("a: {size 0.03}", 5, "put a colon between them: `size: 0.03`"),
        ("a: {timestep = 0.1}", 5, "put a colon between them: `timestep: 0.1`"),
        ('a: [{geom "**", class: b}]', 6, 'put a colon between them: `geom: "**"`'),
        ("a: {tool:hand, b: 1}", 5, "put a space behind the colon: `tool: hand`"),
        ("a: {pos: 0.5, 0, 0, geom: {}}", 15, "put brackets around the numbers: `pos: […]`"),
        ("a: {pos: (0, 0, 1)}", 14, "put brackets around the numbers: `pos: […]`"),
        ("a: {0, 0.1, 0}", 5, "put brackets around the numbers: `[…]`"),
        ("a: {0 0.1 0}", 5, "put brackets around the numbers: `[0, 0.1, 0]`"),
        ('{"a\\nb"}', 2, 'write `"a b": …` with its value, or `["a b"]` for a list'),
        ("a: {b, c}", 5, "write `b: …` with its value, or `[b]` for a list"),
        ('a: {b: 1, "c d"}', 11, 'write `"c d": …` with its value, or `["c d"]` for a list'),
    ],
)
def test_a_key_without_a_colon_is_one_fault(text: str, column: int, help: str) -> None:
    sink = Sink()
    load(text, "r.yaml", sink)
    (found,) = sink.diagnostics
    assert found.code == "yaml-syntax"
    assert found.span is not None and found.span.column == column
    assert found.help == help


@pytest.mark.parametrize("text", ["{b: , c: 1}", "{b: }", '{"b":, c: 1}', "{b : # x\n, c: 1}", "{? b : c}"])
def test_a_key_without_a_value_may_stand(text: str) -> None:
    sink = Sink()
    assert load(text, "r.yaml", sink) is not None
    assert not sink.diagnostics
