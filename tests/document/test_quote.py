from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from composer.diagnostics import Sink
from composer.document import load, to_python
from composer.document.quote import in_flow, quoted, unquoted_end, unquoted_start


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
    [
        ("[1, -${x}]", "-"),
        ("{a: 2 * ${x}}", "2 * "),
        ("[${x}]", ""),
        ("{a: 1,\n  ${x}: 2}", ""),
        ("[- ${x}]", ""),
    ],
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
