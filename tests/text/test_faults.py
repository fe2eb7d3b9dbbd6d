from __future__ import annotations

import pytest
from hypothesis import given, settings, strategies as st
from mjcompose.base.sink import Sink
from mjcompose.text.faults import in_flow, quoted, unquoted_end, unquoted_start
from mjcompose.text.load import load
from mjcompose.text.node import to_python


@settings(deadline=None)
@given(st.text(st.characters(min_codepoint=32, max_codepoint=0x24F, exclude_categories=["Cc"])))
def test_quoted_text_reads_back(text: str) -> None:
    tree = load(f"a: {quoted(text)}", "r.yaml", Sink())
    assert tree is not None
    assert to_python(tree) == {"a": text}


@pytest.mark.parametrize(
    ("text", "flow", "meant"),
    [
        ("**/x", False, "**/x"),
        ("**/x  # why", False, "**/x"),
        ("**/x: 1", False, "**/x"),
        ("a, b", False, "a, b"),
        ("a, b", True, "a"),
        ("a] c", True, "a"),
        ("${v[0]} }", True, "${v[0]}"),
        ("${max(a, b)}, 1", True, "${max(a, b)}"),
        ('${a == "}"}, 1', True, '${a == "}"}'),
        ("**/{a,b}_x}", True, "**/{a,b}_x"),
        ("${x\n}", True, "${x"),
        ("a:b", True, "a:b"),
    ],
)
def test_unquoted_end(text: str, flow: bool, meant: str) -> None:
    assert text[: unquoted_end(text, 0, flow)] == meant


@pytest.mark.parametrize(
    ("text", "meant"),
    [("[1, -${x}]", "-"), ("{a: 2 * ${x}}", "2 * "), ("[${x}]", ""), ("{a: 1,\n  ${x}: 2}", ""), ("[- ${x}]", "")],
)
def test_unquoted_start(text: str, meant: str) -> None:
    index = text.index("$")
    assert text[unquoted_start(text, index) : index] == meant


@pytest.mark.parametrize(
    ("before", "outer", "inside"),
    [
        ("a: ", False, False),
        ("a: [", False, True),
        ("a: [1] ", False, False),
        ('a: "[" ', False, False),
        ("x, ", True, True),
        ("x] ", True, False),
        ("a: [\nb: ", False, False),
    ],
)
def test_in_flow(before: str, outer: bool, inside: bool) -> None:
    assert in_flow(before + "x", len(before), outer) is inside


@pytest.mark.parametrize(
    ("text", "column", "help"),
    [
        ("a: {size 0.03}", 5, "put a colon between them: `size: 0.03`"),
        ("a: {timestep = 0.1}", 5, "put a colon between them: `timestep: 0.1`"),
        ('a: [{geom "**", class: b}]', 6, 'put a colon between them: `geom: "**"`'),
        ("a: {tool:hand, b: 1}", 5, "put a space after the colon: `tool: hand`"),
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
