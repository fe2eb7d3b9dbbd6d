from __future__ import annotations

import json
import pickle
import re
import unicodedata
from dataclasses import replace
from xml.etree import ElementTree as Xml

import pytest
from mjcompose.base import report as shown_text
from mjcompose.base.diagnostic import CellName, Diagnostic, Note, Severity, Span
from mjcompose.base.report import (
    Case,
    MjcomposeError,
    Suite,
    as_lines,
    json_text,
    one_line,
    printable,
    render,
    render_github,
    render_json_format,
    render_markdown,
    report,
    summary,
)

FOUND = [Diagnostic("bad-name", "a", Span("f.yaml", 1, 2), help="h"), Diagnostic("bare-angle", "b")]


def test_carries_and_shows_every_diagnostic() -> None:
    with pytest.raises(MjcomposeError) as caught:
        raise MjcomposeError(iter(FOUND))
    assert caught.value.diagnostics == tuple(FOUND)
    assert str(caught.value) == "f.yaml:1:2: error[bad-name]: a\n  = help: h\nerror[bare-angle]: b"


def test_survives_pickling() -> None:
    again = pickle.loads(pickle.dumps(MjcomposeError(FOUND)))
    assert isinstance(again, MjcomposeError)
    assert again.diagnostics == tuple(FOUND)


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
    assert found == ["::error title=bad-name::x", "::warning title=bad-name::x", "::notice title=bad-name::x"]


def test_escapes() -> None:
    line = render_github(
        Diagnostic("bad-name", "50% a,b: c\r\nd", Span("C:\\a,b%\n.yaml", 1, 1), notes=(Note("n"),), help="h\ni")
    )
    assert line == (
        "::error file=C%3A\\a%2Cb%25%0A.yaml,line=1,col=1,title=bad-name::50%25 a,b: c%0Ad%0Anote: n%0Ahelp: h%0Ai"
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


def test_everything_is_there() -> None:
    line = render_json_format(
        Diagnostic(
            "bad-name",
            "zwei\nZeilen „ü“ \u2028",
            Span("a b.yaml", 3, 4, 3, 9),
            Severity.WARNING,
            (Note("n"), Note("m", Span("c", 1, 1))),
            "h",
            cells=(CellName("a-1-s0002", "a-1", 2), CellName("a-2")),
        )
    )
    assert line.splitlines() == [line]
    assert line.isascii()
    assert json.loads(line) == {
        "severity": "warning",
        "code": "bad-name",
        "message": "zwei\nZeilen „ü“ \u2028",
        "span": {"file": "a b.yaml", "line": 3, "column": 4, "end_line": 3, "end_column": 9},
        "notes": [
            {"message": "n", "span": None},
            {"message": "m", "span": {"file": "c", "line": 1, "column": 1, "end_line": None, "end_column": None}},
        ],
        "help": "h",
        "fix": None,
        "others": [],
        "cells": [{"name": "a-1-s0002", "cell": "a-1", "sample": 2}, {"name": "a-2", "cell": None, "sample": None}],
        "recipes": [],
    }


def test_keys_are_the_same_for_every_diagnostic() -> None:
    full = Diagnostic("bad-name", "a", Span("f", 1, 1), notes=(Note("n"),), help="h")
    assert (
        json.loads(render_json_format(full)).keys()
        == json.loads(render_json_format(Diagnostic("bad-name", "a"))).keys()
    )


FAULT = Diagnostic("check-failed", "`nu` is 8, not <7>", Span("a.yaml", 2, 3, 2, 5), notes=(Note("expected: 7"),))


def test_a_suite_for_each_file_and_a_case_for_each_check() -> None:
    cases = [Case("dims", "size", [FAULT], "a.yaml", 2), Case("left/reach", "reachable", [], "b.yaml", 9)]
    root = Xml.fromstring(report([Suite("a.yaml", cases), Suite("c.yaml", [])], lambda _: "x\n  dims: 1"))
    first, second = root.findall("testsuite")
    assert (first.get("name"), first.get("tests"), first.get("failures")) == ("a.yaml", "2", "1")
    assert (second.get("tests"), second.get("failures")) == ("0", "0")
    failed, passed = first.findall("testcase")
    assert (failed.get("classname"), failed.get("name"), failed.get("line")) == ("a.yaml.size", "dims", "2")
    assert (passed.get("name"), passed.get("file"), len(passed)) == ("left/reach", "b.yaml", 0)
    failure = failed.find("failure")
    assert failure is not None and failure.text is not None
    assert (failure.get("type"), failure.get("message")) == ("check-failed", "`nu` is 8, not <7>")
    assert failure.text.startswith("a.yaml:2:3: error[check-failed]: `nu` is 8, not <7>")
    assert "expected: 7" in failure.text


def test_what_xml_cannot_hold_is_replaced() -> None:
    fault = Diagnostic("check-failed", "a\x00b\x1b", None)
    root = Xml.fromstring(report([Suite("a", [Case("n", "k", [fault])])], lambda _: None))
    failure = root.find(".//failure")
    assert failure is not None and failure.get("message") == "a␀b␛"


def test_the_cell_of_a_suite_is_a_property() -> None:
    root = Xml.fromstring(report([Suite("a.yaml", [], CellName("a-1-s0002", "a-1", 2))], lambda _: None))
    found = {each.get("name"): each.get("value") for each in root.iter("property")}
    assert found == {"name": "a-1-s0002", "cell": "a-1", "sample": "2"}


def lines(diagnostic: Diagnostic, source: str, color: bool = False) -> list[str]:
    return render(diagnostic, {"r.yaml": source}.get, color).split("\n")


def at(line: int, column: int, end_column: int | None = None, end_line: int | None = None) -> Span:
    return Span("r.yaml", line, column, end_line or (line if end_column else None), end_column)


def underlined(diagnostic: Diagnostic, source: str) -> str:
    """The characters of the shown source line that stand above the underline."""
    shown, marks = lines(diagnostic, source)[2:4]
    return "".join(c for c, mark in zip(shown.ljust(len(marks)), marks, strict=False) if mark == "^")


def test_whole_rendering() -> None:
    source = "a: 1\n" * 8 + "attach:\n  gripper: {modle: x}\n"
    diagnostic = Diagnostic(
        "unknown-key",
        "unknown key `modle`",
        at(10, 13, 18),
        notes=(Note("keys that exist: model, with"), Note("the part begins here", at(9, 1, 7))),
        help="write\nattach:\n  gripper: {model: x}",
    )
    assert lines(diagnostic, source) == [
        "r.yaml:10:13: error[unknown-key]: unknown key `modle`",
        "   |",
        "10 |   gripper: {modle: x}",
        "   |             ^^^^^",
        "   = note: keys that exist: model, with",
        "   = note: r.yaml:9:1: the part begins here",
        "   |",
        " 9 | attach:",
        "   | ------",
        "   = help: write",
        "           attach:",
        "             gripper: {model: x}",
    ]


def test_without_span_and_without_source() -> None:
    assert render(Diagnostic("bad-name", "no")) == "error[bad-name]: no"
    placed = Diagnostic("bad-name", "no", at(3, 1), Severity.WARNING)
    assert render(placed) == "r.yaml:3:1: warning[bad-name]: no"
    assert render(placed, lambda file: None) == render(placed)


@pytest.mark.parametrize("line", [0, 3, 99])
def test_line_that_the_file_does_not_have_is_left_out(line: int) -> None:
    assert len(lines(Diagnostic("bad-name", "no", at(line, 1)), "a\nb")) == 1


def test_position_without_end_is_one_caret() -> None:
    assert underlined(Diagnostic("bad-name", "no", at(1, 2)), "abc") == "b"


def test_empty_span_and_span_past_the_end_are_one_caret() -> None:
    assert lines(Diagnostic("bad-name", "no", at(1, 4, 4)), "abc")[3] == "  |    ^"
    assert lines(Diagnostic("bad-name", "no", at(1, 40, 50)), "abc")[3] == "  |    ^"


def test_span_over_several_lines_is_underlined_to_the_end_of_the_first() -> None:
    assert underlined(Diagnostic("bad-name", "no", at(1, 3, 2, end_line=2)), "ab cd  \nef") == " cd"


def test_tabs_are_shown_as_four_columns() -> None:
    shown, marks = lines(Diagnostic("bad-name", "no", at(1, 3, 5)), "\ta\tbc")[2:4]
    assert shown == "1 |     a    bc"
    assert marks.index("^") == shown.index("a") + 1
    assert marks.count("^") == 5  # the tab and `b`


def test_wide_and_combining_characters() -> None:
    wide = lines(Diagnostic("bad-name", "no", at(1, 3, 5)), "機械left")[3]
    assert wide == "  |     ^^"
    on_wide = lines(Diagnostic("bad-name", "no", at(1, 1, 3)), "機械left")[3]
    assert on_wide == "  | ^^^^"
    combining = lines(Diagnostic("bad-name", "no", at(1, 3, 4)), "e\u0301x")[3]
    assert combining == "  |  ^"


def test_characters_that_a_terminal_acts_upon_are_replaced() -> None:
    text = render(Diagnostic("bad-name", "a\x1b[31mb\u202e", at(1, 1)), lambda file: "x\x00\x1b\u2066\x9b")
    assert "\x1b" not in text and "\u202e" not in text and "\u2066" not in text and "\x9b" not in text
    assert "␛[31mb" in text


@pytest.mark.parametrize("column", [1, 50, 150, 161, 500, 996])
def test_long_lines_are_windowed_around_the_span(column: int) -> None:
    source = "".join(f"{i:04d}," for i in range(200))
    diagnostic = Diagnostic("bad-name", "no", at(1, column, column + 4))
    shown = lines(diagnostic, source)[2]
    assert underlined(diagnostic, source) == source[column - 1 : column + 3]
    assert len(shown) <= len("1 | ") + 162
    assert shown.endswith("…") == (column < 900)
    assert shown.startswith("1 | …") == (column > 100)


def test_span_longer_than_the_window_is_cut() -> None:
    marks = lines(Diagnostic("bad-name", "no", at(1, 1, 900)), "x" * 1000)[3]
    assert marks.count("^") == 160


def test_line_of_exactly_the_window_is_whole() -> None:
    assert "…" not in render(Diagnostic("bad-name", "no", at(1, 1)), lambda file: "x" * 160)


def test_all_line_breaks_count_and_the_byte_order_mark_does_not() -> None:
    source = "\ufeffa\r\nb\rc\nd"
    assert [lines(Diagnostic("bad-name", "no", at(n, 1)), source)[2] for n in (1, 2, 3, 4)] == [
        "1 | a",
        "2 | b",
        "3 | c",
        "4 | d",
    ]


def test_other_unicode_line_separators_do_not_count() -> None:
    assert lines(Diagnostic("bad-name", "no", at(2, 1)), "a\u2028b\x0cc\nd")[2] == "2 | d"


def test_color_only_when_asked() -> None:
    diagnostic = Diagnostic("bad-name", "no", at(1, 1), help="do")
    plain = render(diagnostic, lambda file: "abc")
    colored = render(diagnostic, lambda file: "abc", color=True)
    assert "\x1b" not in plain
    assert "\x1b[1;31merror[bad-name]\x1b[0m" in colored
    assert re.sub(r"\x1b\[[0-9;]*m", "", colored) == plain


def test_others_of_the_same_cause_are_listed_one_a_line_before_the_help() -> None:
    others = tuple(Note(f"`{n}.obj`", at(n, 1)) for n in range(2, 12))
    diagnostic = Diagnostic("asset-missing", "no", at(1, 1), notes=(Note("n"),), help="do", others=others)
    shown = render(diagnostic).split("\n")
    assert shown[1:4] == ["  = note: n", "  = note: 10 more like this:", "          r.yaml:2:1: `2.obj`"]
    assert shown[-3:] == ["          r.yaml:9:1: `9.obj`", "          … and 2 more", "  = help: do"]


def test_summary() -> None:
    error = Diagnostic("bad-name", "a")
    warning = Diagnostic("bad-name", "b", severity=Severity.WARNING)
    note = Diagnostic("bad-name", "c", severity=Severity.NOTE)
    assert summary([error, error, warning]) == "2 errors, 1 warning"
    assert summary([warning, warning, note]) == "2 warnings, 1 note"
    assert summary([]) == "no errors"


def test_cells_are_named_text() -> None:
    cells = tuple(CellName(f"a-s000{n}", None, n) for n in range(3))
    fault = Diagnostic("bad-name", "x", notes=(Note("n"),), cells=cells)
    assert lines(fault, "")[1:] == ["  = cells: a-s0000 … a-s0002", "  = note: n"]
    assert lines(replace(fault, cells=cells[:1]), "")[1] == "  = cell: a-s0000"
    assert "a-s0000" in "".join(lines(fault, "", color=True))


def test_a_line_as_long_as_a_file_costs_no_more_than_a_short_one(monkeypatch: pytest.MonkeyPatch) -> None:
    line = "<!-- " + "a-b " * 2_000_000 + "-->"
    counted: list[str] = []
    cell = shown_text._cell
    monkeypatch.setattr(shown_text, "_cell", lambda character: counted.append(character) or cell(character))
    for column in (1, 3_000_001, len(line)):
        shown = render(Diagnostic("bad-name", "m", Span("f", 1, column, 1, column + 2)), lambda _: line)
        _, _, excerpt, underline = shown.splitlines()
        at = underline.index("^")
        assert excerpt[at] == line[column - 1] and len(excerpt) < 200
    assert 200 < len(counted) < 20_000


HOSTILE = "\x07\x1b]0;a\x1b[2J\x7f\x85\x9b31m\u061c\u200e\u202a\u202e\u2066\u2069\u2028\u2029\ud800"
"""Every character is one that acts, with some that do not after it."""


@pytest.mark.parametrize("form", ["text", "github", "junit", "markdown", "line"])
def test_no_character_acts_on_who_shows_it(form: str) -> None:
    from mjcompose.base import report as github, report as junit

    places = tuple(Note(f"note {HOSTILE}", Span(f"a{HOSTILE}.xml", 1, 1)) for _ in range(2))
    found = Diagnostic(
        "bad-name",
        f"a {HOSTILE} b",
        Span(f"a{HOSTILE}.xml", 1, 1),
        notes=places,
        help=HOSTILE,
        cells=(CellName(HOSTILE),),
    )
    if form == "text":
        said = render(found, lambda file: f"<a name='{HOSTILE}'/>")
    elif form == "github":
        said = github.render_github(found)
    elif form == "junit":
        case = junit.Case(f"case {HOSTILE}", HOSTILE, [found], f"a{HOSTILE}.xml", 1)
        said = junit.report([junit.Suite(HOSTILE, [case], CellName(HOSTILE))], lambda file: HOSTILE)
    else:
        said = printable(f"a{HOSTILE}\r\nb\tc\rd\né", colors=form == "line").replace("\ud800", "")
        assert said.count("\n") == 2 and "b\tc" in said and said.endswith("é")
    acts = [each for each in said if unicodedata.category(each) in ("Cc", "Cs", "Zl", "Zp") and each not in "\n\t"]
    assert acts == [] and not set(said) & set(
        "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
    )


def test_colors_stay_where_they_are_meant() -> None:
    assert printable("\x1b[1;31mred\x1b[0m\x1b[2J", colors=True) == "\x1b[1;31mred\x1b[0m\u241b[2J"
    assert printable("\x1b[1;31mred") == "\u241b[1;31mred"


NAMES = [
    "\n::error file=a.py::planted",
    "\r\n  ::add-mask::x",
    "##[error]planted",
    "##vso[task.complete]x",
    "\x1b]0;title\x07",
    "\x1b[31m",
    "\u202egpj.exe",
    "\u200bhidden",
    "\U000e0041\U000e0042",
    "\u2028",
    "\ufeff",
    "<script>alert(1)</script>",
    "`|`",
    "``",
    "`<b>`",
    "a`<img src=x>",
    "@someone",
    "&#64;someone",
    "[a](http://example.org)",
    "]]>",
    "\n# heading",
    "\n- item",
    "\n```",
    "\x00\x01",
    "\udce9",
]
RUN_BY_MACHINES = re.compile(r"(?m)^\s*::|##\w*\[")
UNSEEN_OR_TURNED = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\u200b\ufeff\U000e0000-\U000e0fff\ud800-\udfff]"
)


def about(text: str) -> Diagnostic:
    """A diagnostic that quotes a name everywhere."""
    name = f"`{text}`"
    notes = (Note(f"there is {name}"), Note(f"and {name}", Span(f"{text}.xml", 1, 1)))
    cells = (CellName(text, text), CellName(f"{text}2", text))
    return Diagnostic(
        "bad-name",
        f"the name {name} is bad",
        Span(f"{text}.xml", 1, 2),
        notes=notes,
        help=f"rename {name}",
        cells=cells,
        others=(Note(f"also {name}", at(2, 1)),),
        recipes=(text, "b.yaml"),
    )


@pytest.mark.parametrize("text", NAMES)
@pytest.mark.parametrize("color", [True, False])
def test_no_machine_carries_out_a_name_in_text(text: str, *, color: bool) -> None:
    shown = render(about(text), lambda file: f"{text}\n{text}", color=color)
    assert not RUN_BY_MACHINES.search(shown)
    assert not UNSEEN_OR_TURNED.search(re.sub(r"\x1b\[[0-9;]*m", "", shown) if color else shown)
    assert "planted" not in [line.strip().removeprefix("::error file=a.py::") for line in shown.splitlines()[:1]]


@pytest.mark.parametrize("text", NAMES)
def test_a_name_is_one_command_for_github(text: str) -> None:
    shown = render_github(about(text))
    assert len(shown.splitlines()) == 1 and shown.startswith("::error ")
    assert "##[" not in shown and not UNSEEN_OR_TURNED.search(shown)
    properties = shown[len("::error ") :].partition("::")[0]
    assert [each.partition("=")[0] for each in properties.split(",")] == ["file", "line", "col", "title"]


@pytest.mark.parametrize("text", NAMES)
def test_a_name_is_only_text_in_markdown(text: str) -> None:
    shown = render_markdown(about(text))
    assert not UNSEEN_OR_TURNED.search(shown) and not RUN_BY_MACHINES.search(shown)
    parser = pytest.importorskip("markdown_it").MarkdownIt("gfm-like", {"html": True, "linkify": False})
    tokens = parser.parse(shown)
    inline = [child for token in tokens for child in token.children or ()]
    kinds = {each.type for each in (*tokens, *inline)}
    assert not kinds & {
        "html_block",
        "html_inline",
        "heading_open",
        "link_open",
        "image",
        "fence",
        "code_block",
        "table_open",
    }
    assert len([each for each in tokens if each.type == "bullet_list_open"]) == 2
    words = "".join(each.content for each in inline if each.type == "text")
    assert "@someone" not in words


@pytest.mark.parametrize("text", NAMES)
def test_a_name_is_only_text_in_junit(text: str) -> None:
    shown = report([Suite(text, [Case(text, text, [about(text)], file=text, line=1)])], lambda file: text)
    assert not UNSEEN_OR_TURNED.search(shown) and not RUN_BY_MACHINES.search(shown)
    [case] = Xml.fromstring(shown).iter("testcase")
    assert [each.tag for each in case] == ["failure"]


@pytest.mark.parametrize("text", NAMES)
@pytest.mark.parametrize("ensure_ascii", [True, False])
def test_a_name_in_json_is_the_same_name_again(text: str, *, ensure_ascii: bool) -> None:
    shown = json_text({"name": text}, ensure_ascii=ensure_ascii)
    assert json.loads(shown) == {"name": text}
    assert len(shown.splitlines()) == 1
    assert not UNSEEN_OR_TURNED.search(shown) and not RUN_BY_MACHINES.search(shown)


@pytest.mark.parametrize("text", ["arm/left", "a_b", "bras_é", "机械臂", "a::b", "std::vector", "# [x]", "می‌خواهم"])
def test_usual_text_stays(text: str) -> None:
    assert printable(text) == text and one_line(text) == text


def test_a_line_break_of_a_name_starts_no_line() -> None:
    assert as_lines(["a\nb", "c\td", "e\rf"]) == "a␊b\nc␉d\ne␍f"
