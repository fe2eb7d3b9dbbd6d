from __future__ import annotations

import sys

import pytest
import yaml
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.sink import Sink
from mjcompose.text.load import load
from mjcompose.text.node import to_python


@pytest.fixture(params=["fast", "pure"], autouse=True)
def reader(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The two readers word their complaints differently; what the user sees is the same."""
    if request.param == "pure":
        monkeypatch.setattr(sys.modules["mjcompose.text.load"], "_FAST", yaml.SafeLoader)
    elif not hasattr(yaml, "CSafeLoader"):
        pytest.skip("PyYAML has no C reader here")


def faults(text: str) -> list[Diagnostic]:
    sink = Sink()
    load(text, "r.yaml", sink)
    return sink.sorted()


def shown(text: str, diagnostic: Diagnostic) -> str:
    span = diagnostic.span
    assert span is not None and span.end_column is not None
    return text.splitlines()[span.line - 1][span.column - 1 : span.end_column - 1]


@pytest.mark.parametrize(
    ("text", "code", "place", "help"),
    [
        ("pos: [0, ${x}]\n", "yaml-template-unquoted", "${x}", 'quote it: "${x}"'),
        ("pos: [${x}]\n", "yaml-template-unquoted", "${x}", 'quote it: "${x}"'),
        ("a: {b: ${x}}\n", "yaml-template-unquoted", "${x}", 'quote it: "${x}"'),
        ("a: {b: -${x[0]} * 2, c: 1}\n", "yaml-template-unquoted", "-${x[0]} * 2", 'quote it: "-${x[0]} * 2"'),
        ("a: [\n  ${x},\n  1]\n", "yaml-template-unquoted", "${x}", 'quote it: "${x}"'),
        ('a: {when: ${g == "h"}}\n', "yaml-template-unquoted", '${g == "h"}', "quote it: '${g == \"h\"}'"),
        ("joint: **/elbow\n", "yaml-alias", "**/elbow", 'quote it: "**/elbow"'),
        ("joint: */elbow  # c\n", "yaml-alias", "*/elbow", 'quote it: "*/elbow"'),
        ("a: {joint: **/s_*, b: 1}\n", "yaml-alias", "**/s_*", 'quote it: "**/s_*"'),
        ("**/x: 1\n", "yaml-alias", "**/x", 'quote it: "**/x"'),
        ("- *\n", "yaml-alias", "*", 'quote it: "*"'),
        ("body: {left,right}/*_l\n", "yaml-syntax", "{left,right}/*_l", 'quote it: "{left,right}/*_l"'),
        ("a: {body: {l,r}/x}\n", "yaml-syntax", "{l,r}/x", 'quote it: "{l,r}/x"'),
        ("a: @x\n", "yaml-syntax", "@x", 'quote it: "@x"'),
        ("a: %x\n", "yaml-syntax", "%x", 'quote it: "%x"'),
        ("a: [`x`]\n", "yaml-syntax", "`x`", 'quote it: "`x`"'),
        ("name: ?\n", "yaml-syntax", "?", 'quote it: "?"'),
        ("a: &/x\n", "yaml-syntax", "&/x", 'quote it: "&/x"'),
    ],
)
def test_text_that_only_lacks_quotes(text: str, code: str, place: str, help: str) -> None:
    (found,) = faults(text)
    assert (found.code, shown(text, found), found.help) == (code, place, help)
    mended = text.replace(place, help.removeprefix("quote it: "), 1)
    assert faults(mended) == []
    assert to_python(load(text, "r.yaml", Sink())) == to_python(load(mended, "r.yaml", Sink()))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ("a:\n\tb: 1\n", "\t", "a tab cannot indent YAML"),
        ("a: 1\n\t\tb: 1\n", "\t\t", "a tab cannot indent YAML"),
        ("a:1\nb: 2\n", ":", "the colon after `a` needs a space after it"),
        ("x: 1\nkey:value\ny: 2\n", "key:value", "`key:value` is neither a key nor part of a value"),
        ("a: b: c\n", ":", "a second `: ` in one line: the value itself cannot be a mapping here"),
        ("a: 1\n  b: 2\n", "b", "`b` is indented as if it belonged to `a`, which already has a value"),
        ("a\nb: 1\n", "b", "`b` cannot be a key here, because the line above is neither a key nor complete"),
        ("a: 1\nb\nc: 2\n", "b", "`b` is neither a key nor part of a value"),
        ("a: [1, 2\nb: 3\n", "[", "this `[` has no `]`"),
        ("a: {b: 1\n", "{", "this `{` has no `}`"),
        ("a: [1 {2]\n", "{2", "expected `,` or `]` before `{2`"),
        ('a: "x\nb: 1\n', '"', 'the quote `"` is never closed'),
        ("a: 'x\n", "'", "the quote `'` is never closed"),
        ('a: "\\d+"\n', "\\d", "`\\d` is not an escape in YAML"),
        ('a: "\\u12"\n', "\\u", "`\\u` must be followed by the 4 hexadecimal digits of a character"),
        ("a:\n  b: 1\n c: 2\n", "c", "the indentation of this line is that of no line above"),
        ("- a\nb: 1\n", "b", "a line without `-` is among the items of a list"),
        ("a: 1\n- b\n", "-", "a list item is among the keys of a mapping"),
        ('a: "x\nb: "y"\n', '"', "this quote is not closed on its line"),
        ('a: "x" y\n', "y", "`y` follows a closing quote"),
        ("a: |x\n", "x", "`|` begins a text block, and its text begins on the next line"),
        ("a: ]\n", "]", "a value is missing before `]`"),
        ("a: [1,,2]\n", ",", "a value is missing before `,`"),
        ("key: - a\n", "-", "a list with `-` cannot begin on the line of its key"),
        ("{a: 1} b\n", "b", "`b` is after the end of the document"),
        ("%YAML 2.0\n---\na\n", "%", "a line that begins with `%` is a YAML directive, and this one is not known"),
    ],
)
def test_faults_that_end_the_reading(text: str, place: str, message: str) -> None:
    (found,) = faults(text)
    assert found.code == "yaml-syntax"
    assert found.message.startswith(message)
    assert place.startswith(shown(text, found))
    assert load(text, "r.yaml", Sink()) is None


@pytest.mark.parametrize(("text", "tag"), [("a: !x!y z\n", "!x!y"), ("a: !<x\n", "!<x"), ("a: !!\n", "!!")])
def test_broken_tags(text: str, tag: str) -> None:
    (found,) = faults(text)
    assert (found.code, shown(text, found)) == ("yaml-tag", tag)


def test_all_faults_of_one_file_at_once() -> None:
    text = (
        "pos: [${a}, 1, ${b}]\n"
        "edit: [{select: {joint: **/x}}]\n"
        "name: a\n"
        "name: b\n"
        "body: {l,r}/x\n"
        "tag: !y z\n"
        "<<: {q: 1}\n"
    )
    assert [(each.span.line, each.code) for each in faults(text) if each.span] == [
        (1, "yaml-template-unquoted"),
        (1, "yaml-template-unquoted"),
        (2, "yaml-alias"),
        (4, "yaml-duplicate-key"),
        (5, "yaml-syntax"),
        (6, "yaml-tag"),
        (7, "yaml-merge-key"),
    ]


def test_faults_before_a_fatal_one_are_reported_too() -> None:
    assert [each.code for each in faults("a: 1\na: 2\nb: !x 1\nc: ]\n")] == [
        "yaml-duplicate-key",
        "yaml-tag",
        "yaml-syntax",
    ]


def test_readings_are_bounded() -> None:
    text = "a: [" + ", ".join(["${x}"] * 200) + "]\n"
    assert 1 < len(faults(text)) <= 51
    assert all(each.code == "yaml-template-unquoted" for each in faults(text))


def test_tabs_are_counted() -> None:
    assert faults("a:\n\tb: 1\n\tc: 2\n")[0].notes[0].message == "2 lines of this file begin with a tab"


def test_escape_that_is_no_character() -> None:
    (found,) = faults('a: "\\U00110000"\n')
    assert "\\U" in found.message
    assert found.span is not None and (found.span.line, found.span.column) == (1, 5)


def test_colon_at_the_end_of_text_in_brackets() -> None:
    helps = [found.help for found in faults("a: [b:]\n")]
    # The reader in Python takes this for a key without a value, as YAML 1.2 does.
    pure = sys.modules["mjcompose.text.load"]._FAST is yaml.SafeLoader  # type: ignore[attr-defined]
    assert helps == ([] if pure else ['quote it: "b:"'])


def test_colon_in_a_later_line_of_text_in_brackets() -> None:
    text = "a: {b\n  c:[1]}\n"
    found = [(shown(text, each), each.help) for each in faults(text)]
    # The reader in Python takes `b c:` for a key.
    pure = sys.modules["mjcompose.text.load"]._FAST is yaml.SafeLoader  # type: ignore[attr-defined]
    assert pure or found == [("c:", "write `c: [1]`")]
    assert all("\n" not in each.message for each in faults("{&\n  :{"))


def test_quoted_expressions_and_globs_are_fine() -> None:
    assert faults('a: [0, "${x}"]\nb: ${x} * 2\nc: "**/x"\nd: ${v[0]}\ne: "{l,r}/*"\nf: a*b/**\n') == []


def test_no_space_before_a_list() -> None:
    if sys.modules["mjcompose.text.load"]._FAST is yaml.SafeLoader:
        pytest.skip("PyYAML's own reader takes it for a key")
    (fault,) = faults("a: {b:[1], c: 2}\n")
    assert fault.message == "a space is missing after the colon of `b`" and fault.help == "write `b: [1]`"
