from __future__ import annotations

import codecs
import json
import re
import sys
from collections.abc import Iterator
from typing import Any

import pytest
import yaml
from hypothesis import given, settings, strategies as st
from mjcompose.base.diagnostic import Span
from mjcompose.base.limits import Limits, allow
from mjcompose.base.sink import Sink
from mjcompose.text.load import Mask, decode, load
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, position, to_python


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


MAX_DEPTH = Limits().yaml_depth
MODULE = sys.modules["mjcompose.text.load"]  # the package has the function under this name

# YAML allows a key 1024 characters, escapes included.
TEXT = st.text(max_size=80)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | TEXT,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXT, inner, max_size=4),
    max_leaves=15,
)


# What JSON allows unescaped in a string and YAML does not.
JSON_ONLY = re.compile("[\x7f-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff]")


@pytest.fixture(scope="module", params=["fast", "pure"], autouse=True)
def reader(request: pytest.FixtureRequest) -> Iterator[str]:
    """Every test runs with the C reader, if there is one, and with the one in Python."""
    if request.param == "fast" and not hasattr(yaml, "CSafeLoader"):
        pytest.skip("PyYAML has no C reader here")
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "pure":
            patch.setattr(MODULE, "_FAST", yaml.SafeLoader)
        yield request.param


def read(text: str | bytes) -> tuple[Any, list[str]]:
    """What is read, as plain values, and the codes of the diagnostics."""
    sink = Sink()
    tree = load(text, "r.yaml", sink)
    return (None if tree is None else to_python(tree)), [each.code for each in sink.diagnostics]


def tree_of(text: str) -> Mapping:
    sink = Sink()
    tree = load(text, "r.yaml", sink)
    assert sink.diagnostics == []
    assert isinstance(tree, Mapping)
    return tree


def first_error(text: str) -> tuple[str, str, str | None]:
    """Code, the underlined text and the help of the only error."""
    sink = Sink()
    load(text, "r.yaml", sink)
    (found,) = sink.diagnostics
    assert found.span is not None
    return found.code, cut(text, found.span), found.help


def cut(text: str, span: Span) -> str:
    return text.splitlines()[span.line - 1][span.column - 1 : (span.end_column or 0) - 1]


# --- values


@settings(deadline=None)
@given(JSON, st.booleans(), st.sampled_from([None, 2]))
def test_json_is_yaml(reader: str, value: object, ascii_only: bool, indent: int | None) -> None:
    text = json.dumps(value, ensure_ascii=ascii_only, indent=indent)
    if JSON_ONLY.search(text):
        return
    found, codes = read(text)
    assert codes == []
    assert repr(found) == repr(value)


def test_keys_are_text_always() -> None:
    assert read("1: a\nno: b\n12:30: c\nnull: d\n1e3: e\n~: f\n'x y': g\n") == (
        {"1": "a", "no": "b", "12:30": "c", "null": "d", "1e3": "e", "~": "f", "x y": "g"},
        [],
    )


def test_only_plain_scalars_have_types() -> None:
    assert read("[1, '1', \"1\", !!str 1, no, null, 'null', ]") == ([1, "1", "1", "1", "no", None, "null"], [])
    assert read("a: |\n  1\nb: >-\n  2\nc:\nd: 010\n") == ({"a": "1\n", "b": "2", "c": None, "d": 10}, [])


def test_text_as_written_and_whether_it_is_plain() -> None:
    entries = tree_of("a: 010\nb: '010'\n").entries
    plain = entries["a"][1]
    quoted = entries["b"][1]
    assert isinstance(plain, Scalar) and isinstance(quoted, Scalar)
    assert (plain.value, plain.text, plain.plain) == (10, "010", True)
    assert (quoted.value, quoted.text, quoted.plain) == ("010", "010", False)


def test_characters_beyond_the_basic_plane_as_json_writes_them() -> None:
    assert read(r'["\ud83d\ude00", "x\uD83D\uDE00y", "\u00e9"]') == (["😀", "x😀y", "é"], [])
    assert read(r"'\ud83d'") == (r"\ud83d", [])
    assert read(r'"\ud83d"')[1] == ["yaml-syntax"]
    assert read(r'"\ude00\ud83d"')[1] == ["yaml-syntax"]


def test_line_separators_of_yaml_1_1_are_characters() -> None:
    text = 'a: "x \u2028 y"\nb: x\x85y\nc: z\n'
    assert read(text) == ({"a": "x \u2028 y", "b": "x\x85y", "c": "z"}, [])
    assert tree_of(text).entries["c"][0].span == Span("r.yaml", 3, 1, 3, 2)


def test_byte_order_mark_does_not_count() -> None:
    sink = Sink()
    tree = load(b"\xef\xbb\xbfa: 1", "r.yaml", sink)
    assert isinstance(tree, Mapping)
    assert tree.entries["a"][0].span.column == 1


@pytest.mark.parametrize(
    "text",
    [
        "k" * 1100 + ": 1\n",
        "a: {b: 1, " + "k" * 1100 + ": 1}\n",
        '{"' + "k" * 1100 + '": 1}',
        "a: 1\n" + "k" * 1100 + ": 1\nb: 2\n",
    ],
)
def test_keys_have_a_length(text: str) -> None:
    sink = Sink()
    assert load(text, "r.yaml", sink) is None
    (found,) = sink.diagnostics
    assert found.message == "a key has more than 1024 characters"
    assert found.span is not None and found.span.column < 12


@pytest.mark.parametrize("text", ["5", "a", "[]", "{}", "null", "~", "--- 5", "--- 5\n...\n", "%YAML 1.2\n---\n5\n"])
def test_any_one_value_is_a_document(text: str) -> None:
    assert read(text)[1] == []


def test_numbers_too_large_to_hold() -> None:
    assert first_error("a: 1e400\n") == ("out-of-range", "1e400", None)
    assert first_error("a: " + "9" * 309 + "\n")[0] == "out-of-range"
    assert read("a: !!float " + "9" * 308)[1] == []
    assert read("{" + "9" * 1010 + ": 1}") == ({"9" * 1010: 1}, [])


# --- places


def test_spans() -> None:
    text = "name:  ünï  # c\nattach:\n  gripper: {model: 'a b', pos: [0, 1.5]}\nlist:\n  - x: 1\n    y: 2\nnone:\n"
    entries = tree_of(text).entries
    assert cut(text, entries["name"][0].span) == "name"
    assert cut(text, entries["name"][1].span) == "ünï"
    attach = entries["attach"][1]
    assert isinstance(attach, Mapping)
    assert attach.span == Span("r.yaml", 3, 3, 3, 41)
    gripper = attach.entries["gripper"][1]
    assert isinstance(gripper, Mapping)
    assert cut(text, gripper.span) == "{model: 'a b', pos: [0, 1.5]}"
    assert cut(text, gripper.entries["model"][1].span) == "'a b'"
    position = gripper.entries["pos"][1]
    assert isinstance(position, Sequence)
    assert cut(text, position.span) == "[0, 1.5]"
    assert cut(text, position.items[1].span) == "1.5"
    items = entries["list"][1]
    assert cut(text, items.span) == "- x: 1"
    assert isinstance(items, Sequence)
    assert cut(text, items.items[0].span) == "x: 1"
    assert entries["none"][1].span == Span("r.yaml", 7, 6, 7, 6)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("|-  # c\n  x\n  y\n", "|-"),
        (">\n  x\n", ">"),
        ('"x  \n  y"\n', '"x'),
        ("x y\n  z\n", "x y"),
        ("[1, 22,\n  3]\n", "[1, 22"),
        ("{a: 1,  # c\n  b: 2}\n", "{a: 1"),
        ("\n  a: {b: 1}  # c\n  d: 2\n", "a: {b: 1}"),
        ("\n  a:  # c\n    b: 1\n", "a"),
        ("\n  - 1  # c\n", "- 1"),
        ("&x 5\n", "5"),
        ("!!str 5\n", "5"),
        ("&x !!map {a: 1}\n", "{a: 1}"),
    ],
)
def test_what_spans_several_lines_is_cut_to_its_first(text: str, shown: str) -> None:
    text = f"key: {text}"
    span = tree_of(text).entries["key"][1].span
    assert cut(text, span) == shown
    assert span.end_line == span.line


@settings(deadline=None)
@given(JSON)
def test_spans_are_inside_their_parents(reader: str, value: object) -> None:
    text = json.dumps(value)
    tree = load(text, "r.yaml", Sink())

    def check(node: Node, outer: Span) -> None:
        assert outer.column <= node.span.column
        assert (node.span.end_column or 0) <= (outer.end_column or 0)
        inner = node.items if isinstance(node, Sequence) else ()
        if isinstance(node, Mapping):
            inner = tuple(value for _, value in node.entries.values())
        for each in inner:
            check(each, node.span)

    assert tree is not None
    check(tree, Span("r.yaml", 1, 1, 1, len(text) + 1))
    assert cut(text, tree.span) == text


# --- what the language does not have


def test_duplicate_keys_name_both_places_and_keep_the_first() -> None:
    text = "a: 1\nb: {c: 1, 'c': 2}\na: 3\na: {d: 1, d: 2}\n"
    sink = Sink()
    tree = load(text, "r.yaml", sink)
    assert tree is not None
    assert to_python(tree) == {"a": 1, "b": {"c": 1}}
    assert [each.code for each in sink.diagnostics] == ["yaml-duplicate-key"] * 4
    places = [(str(each.span), str(each.notes[0].span)) for each in sink.sorted()]
    assert places == [
        ("r.yaml:2:11", "r.yaml:2:5"),
        ("r.yaml:3:1", "r.yaml:1:1"),
        ("r.yaml:4:1", "r.yaml:1:1"),
        ("r.yaml:4:11", "r.yaml:4:5"),
    ]


def test_merge_keys() -> None:
    assert read("x: &x {a: 1}\ny: {<<: *x, b: 2}\n") == ({"x": {"a": 1}, "y": {"b": 2}}, ["yaml-merge-key"])
    assert read("'<<': 1\n") == ({"<<": 1}, [])
    assert read("a: <<\n") == ({"a": "<<"}, [])


@pytest.mark.parametrize(
    ("text", "tag"),
    [
        ("a: !include x.yaml\n", "!include"),
        ("a: !!python/name:os.system x\n", "!!python/name:os.system"),
        ("a: !!binary aGk=\n", "!!binary"),
        ("a: !x {b: 1}\n", "!x"),
        ("a: &y !x [1]\n", "!x"),
        ("!x a: 1\n", "!x"),
        ("a: !<tag:x,2000:y> 1\n", "!<tag:x,2000:y>"),
        ("a: !x\n", "!x"),
        ("a: !!set {b}\n", "!!set"),
        ("a: !!map [b]\n", "!!map"),
        ("a: !!str [b]\n", "!!str"),
    ],
)
def test_tags_are_refused_and_their_values_kept(text: str, tag: str) -> None:
    assert first_error(text)[:2] == ("yaml-tag", tag)
    assert read(text)[0] is not None


def test_standard_tags_are_heeded() -> None:
    text = "[!!str 010, !!int '7', !!float 1.5, !!bool true, !!null '', !!map {}, !!seq [], ! 5, !!float 1]"
    assert read(text) == (["010", 7, 1.5, True, None, {}, [], "5", 1], [])
    assert first_error("a: !!int x\n")[:2] == ("yaml-tag", "x")
    assert first_error("a: !!int true\n")[:2] == ("yaml-tag", "true")
    assert first_error("a: !!bool 1\n")[:2] == ("yaml-tag", "1")


@pytest.mark.parametrize(
    ("text", "shown"), [("[a]: 1\n", "["), ("? {a: b}\n: 1\n", "{a: b}"), ("{{x}}", "{"), ("? - a\n: 1\n", "")]
)
def test_keys_that_are_no_scalars(text: str, shown: str) -> None:
    code, place, _ = first_error(text)
    assert code == "yaml-key"
    assert place.startswith(shown[:1])
    assert read(text)[0] == {}


def test_template_braces_of_other_tools_are_recognised() -> None:
    assert first_error("a: {{ x }}\n") == ("yaml-key", "{", 'quote text with braces; write an expression as "${…}"')


def test_several_documents() -> None:
    text = "a: 1\n---\nb: 2\n"
    assert first_error(text)[:2] == ("yaml-documents", "---")
    assert read(text)[0] == {"a": 1}


@pytest.mark.parametrize("text", ["", " \n\n", "# only this\n", "---\n", "---\n...\n", "\ufeff", b""])
def test_nothing(text: str | bytes) -> None:
    assert read(text) == (None, ["yaml-empty"])


# --- aliases


def test_aliases_stand_for_what_they_name() -> None:
    text = "a: &x {b: [1, 2]}\nc: *x\nd: &y k\n*y : 5\n&z e: *z\n"
    assert read(text) == ({"a": {"b": [1, 2]}, "c": {"b": [1, 2]}, "d": "k", "k": 5, "e": "e"}, [])
    entries = tree_of(text).entries
    assert cut(text, entries["c"][1].span) == "*x"
    copy = entries["c"][1]
    assert isinstance(copy, Mapping)
    assert copy.entries["b"][0].span.line == 1


def test_an_alias_takes_the_latest_anchor() -> None:
    assert read("[&a 1, *a, &a 2, *a]") == ([1, 1, 2, 2], [])


def test_alias_that_names_nothing_is_probably_a_glob() -> None:
    assert first_error("joint: *elbow\n") == ("yaml-alias", "*elbow", 'if it is text, quote it: "*elbow"')
    assert read("joint: *elbow\n")[0] == {"joint": "*elbow"}
    assert read("*elbow : 1\n")[0] == {"*elbow": 1}


def test_alias_of_a_collection_is_no_key() -> None:
    assert first_error("a: &x [1]\n*x : 2\n")[:2] == ("yaml-key", "*x")


def test_alias_within_what_it_names() -> None:
    assert read("a: &x [1, *x]\n") == (None, ["yaml-alias-bomb"])
    assert read("a: &x 1\nb: &x {c: {d: *x}}\n") == (None, ["yaml-alias-bomb"])


def test_billion_laughs() -> None:
    text = "a: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
    for level in range(1, 30):
        text += f"a{level}: &a{level} [{', '.join([f'*a{level - 1}'] * 10)}]\n"
    assert read(text) == (None, ["yaml-alias-bomb"])


def test_deep_nesting_by_aliases() -> None:
    text = "a0: &a0 []\n" + "".join(f"a{n}: &a{n} [*a{n - 1}]\n" for n in range(1, MAX_DEPTH - 1))
    assert read(text)[1] == []
    assert read(text + f"b: [*a{MAX_DEPTH - 2}]\n")[1] == ["yaml-too-deep"]


def test_reasonable_sharing_is_fine() -> None:
    assert read("a: &a [1, 2, 3]\nb: [" + ", ".join(["*a"] * 2000) + "]\n")[1] == []


# --- bounds


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "? ", "[{a: "])
def test_depth_is_bounded(opening: str) -> None:
    sink = Sink()
    assert load(opening * 100_000, "r.yaml", sink) is None
    assert [each.code for each in sink.diagnostics][-1] in ("yaml-too-deep", "yaml-syntax")


def test_depth_limit_is_exact() -> None:
    assert read("[" * MAX_DEPTH + "]" * MAX_DEPTH)[1] == []
    assert read("[" * (MAX_DEPTH + 1) + "]" * (MAX_DEPTH + 1)) == (None, ["yaml-too-deep"])


def test_number_of_values_is_bounded() -> None:
    with allow(yaml_values=20):
        assert read("[" + "1, " * 19 + "]")[1] == []
        assert read("[" + "1, " * 20 + "]") == (None, ["yaml-too-large"])


def test_the_values_of_aliases_count() -> None:
    text = "a: &a [" + "1, " * 10 + "]\nb: *a\n"
    with allow(yaml_values=30):
        assert read(text)[1] == []
    with allow(yaml_values=20):
        assert read(text)[0] is None and read(text)[1] != []


def test_the_bounds_can_be_raised() -> None:
    with allow(yaml_depth=MAX_DEPTH + 1):
        assert read("[" * (MAX_DEPTH + 1) + "]" * (MAX_DEPTH + 1))[1] == []


# --- anything at all

PIECES = st.lists(
    st.sampled_from(
        [
            *"{}[],:#&*!|>-?'\"%@`~$\\ \n\t",
            *("${x}", "a", "1", "key: ", "- ", ": ", "\n  ", "\r\n", "---\n", "...", "<<: "),
            *("*a", "&a ", "!!str ", "!x ", "**/b", "{l,r}/*", "\\ud83d", "\\U00110000"),
            *("\u2028", "\x85", "é", "\ufeff", "1e999"),
        ]
    ),
    max_size=25,
).map("".join)


@settings(deadline=None, max_examples=400)
@given(PIECES | st.text(max_size=30) | st.binary(max_size=30))
def test_never_an_exception_and_never_silence(reader: str, text: str | bytes) -> None:
    sink = Sink()
    tree = load(text, "r.yaml", sink)
    if tree is None:
        assert sink.has_errors
    for each in sink.diagnostics:
        assert each.message and each.span is not None
        assert each.span.line >= 1 and each.span.column >= 1
        assert "\n" not in each.message


@settings(deadline=None, max_examples=200)
@given(PIECES)
def test_what_is_accepted_is_what_pyyaml_accepts(reader: str, text: str) -> None:
    """Text that is only masked and re-read must not become acceptable without an error."""
    sink = Sink()
    load(text, "r.yaml", sink)
    try:
        list(yaml.parse(text.removeprefix("\ufeff"), Loader=yaml.SafeLoader))
    except (yaml.YAMLError, ValueError, OverflowError):
        if reader == "pure" and not re.search("[\x85\u2028]", text):
            assert sink.has_errors


@settings(deadline=None, max_examples=100)
@given(PIECES)
def test_bytes_and_text_are_read_alike(reader: str, text: str) -> None:
    assert repr(read(text)) == repr(read(text.encode()))
