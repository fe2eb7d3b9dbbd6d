from __future__ import annotations

import pytest

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.fix import Fix
from composer.diagnostics.span import Span
from composer.fixing.edit import Edit, applied, edit_of, exact


def found(fix: Fix | None, span: Span | None) -> Diagnostic:
    return Diagnostic("unknown-name", "no", span, fix=fix)


def at(line: int, column: int, end: int | None = None, file: str = "a.yaml") -> Span:
    return Span(file, line, column, None if end is None else line, end)


@pytest.mark.parametrize(
    ("source", "span", "fix", "result"),
    [
        ("x: tpi\n", at(1, 4, 7), Fix("tip", "tpi"), "x: tip\n"),
        ("x: 'tpi'\n", at(1, 4, 9), Fix("tip", "tpi"), 'x: "tip"\n'),
        ("x: tpi\n", at(1, 4, 7), Fix("*tip", "tpi"), 'x: "*tip"\n'),
        ("é: 1\r\nx: tpi # c\r\n", at(2, 4, 7), Fix("tip", "tpi"), "é: 1\r\nx: tip # c\r\n"),
        ("x: 1 2\n", at(1, 4, 7), Fix("[1, 2]"), "x: [1, 2]\n"),
        ("x: [1, 2]\n", at(1, 4, 10), Fix("[1deg, 2]"), "x: [1deg, 2]\n"),
        ("# c\nx: 1\n", at(2, 1), Fix("recipe: 1\n"), "# c\nrecipe: 1\nx: 1\n"),
        ("x: 1\n", at(1, 1, 2), Fix("y", "x", at(1, 1, 2)), "y: 1\n"),
        ('<a b="tpi"/>', at(1, 7, 10, "a.xml"), Fix("a*", "tpi"), '<a b="a*"/>'),
    ],
)
def test_what_it_writes(source: str, span: Span, fix: Fix, result: str) -> None:
    edit = edit_of(found(fix, span), source)
    assert edit is not None and applied(source, [edit]) == result


@pytest.mark.parametrize(
    ("source", "span", "fix"),
    [
        ("x: other\n", at(1, 4, 9), Fix("tip", "tpi")),
        ("x: [1,\n  2]\n", at(1, 4, 7), Fix("[1, 2deg]")),
        ("x: tpi\n", at(3, 4, 7), Fix("tip", "tpi")),
        ("x: tpi\n", at(1, 4, 99), Fix("tip", "tpi")),
        ("x: tpi\n", Span("a.yaml", 1, 4, 2, 1), Fix("tip", "tpi")),
        ("x: tpi\n", None, Fix("tip", "tpi")),
        ("x: tpi\n", at(1, 4, 7), None),
    ],
)
def test_what_does_not_fit_is_left(source: str, span: Span | None, fix: Fix | None) -> None:
    diagnostic = found(fix, span)
    assert edit_of(diagnostic, source) is None
    assert exact(diagnostic, source).fix is None


def test_exact_has_the_quotes() -> None:
    told = exact(found(Fix("**/tip", "tpi"), at(1, 4, 7)), "x: tpi\n")
    assert told.fix == Fix('"**/tip"', None, at(1, 4, 7))


def test_two_equal_edits_are_one() -> None:
    assert applied("ab", [Edit(0, 1, "x"), Edit(0, 1, "x")]) == "xb"
