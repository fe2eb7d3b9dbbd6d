from __future__ import annotations

from composer.diagnostics import Diagnostic, Note, Severity, Span, render_github
from composer.diagnostics.cell_name import CellName


def test_place_and_title() -> None:
    assert (
        render_github(Diagnostic("bad-name", "no", Span("dir/f.yaml", 3, 4, 3, 9)))
        == "::error file=dir/f.yaml,line=3,col=4,endLine=3,endColumn=9,title=bad-name::no"
    )


def test_no_end_column_when_the_end_is_on_another_line() -> None:
    assert (
        render_github(Diagnostic("bad-name", "no", Span("f", 3, 4, 5, 9)))
        == "::error file=f,line=3,col=4,endLine=5,title=bad-name::no"
    )


def test_severities() -> None:
    found = [render_github(Diagnostic("bad-name", "x", severity=severity)) for severity in Severity]
    assert found == [
        "::error title=bad-name::x",
        "::warning title=bad-name::x",
        "::notice title=bad-name::x",
    ]


def test_escapes() -> None:
    line = render_github(
        Diagnostic(
            "bad-name", "50% a,b: c\r\nd", Span("C:\\a,b%\n.yaml", 1, 1), notes=(Note("n"),), help="h\ni"
        )
    )
    assert line == (
        "::error file=C%3A\\a%2Cb%25%0A.yaml,line=1,col=1,title=bad-name"
        "::50%25 a,b: c%0Ad%0Anote: n%0Ahelp: h%0Ai"
    )
    assert "\n" not in line and "\r" not in line


def test_note_with_a_place_names_it() -> None:
    assert render_github(Diagnostic("bad-name", "x", notes=(Note("n", Span("f", 2, 3)),))).endswith(
        "::x%0Anote: f:2:3: n"
    )


def test_cells_are_named() -> None:
    cells = (CellName("a-1"), CellName("a-2"))
    assert render_github(Diagnostic("bad-name", "x", cells=cells[:1])) == "::error title=bad-name in a-1::x"
    assert (
        render_github(Diagnostic("bad-name", "x", cells=cells))
        == "::error title=bad-name in 2 cells::x%0Acells: a-1, a-2"
    )
