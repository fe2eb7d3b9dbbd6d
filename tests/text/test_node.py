from __future__ import annotations

import math
import re

import pytest
from hypothesis import given, settings, strategies as st
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, check_characters, locate, resolve, to_python


@pytest.mark.parametrize(
    ("text", "place", "character"),
    [(r'a: "\0"', (1, 4), "U+0000"), (r'"\e": 1', (1, 1), "U+001B"), (r'a: [1, {b: "x\uFFFE"}]', (1, 12), "U+FFFE")],
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


TEXT = """\
sensor:
  imu: {type: force, site: tip}
  type: {site: a, objtype: b}
add:
  - to: world
    body:
      pos: [0, 1]
"""


@pytest.fixture
def tree() -> Node:
    found = load(TEXT, "r.yaml", Sink())
    assert found is not None
    return found


def written(span: Span) -> str:
    return TEXT.splitlines()[span.line - 1][span.column - 1 : (span.end_column or 0) - 1]


@pytest.mark.parametrize(
    ("path", "value", "key"),
    [
        (("sensor", "imu", "site"), "tip", "site"),
        (("sensor", "imu"), "{type: force, site: tip}", "imu"),
        (("add", 0, "body", "pos", 1), "1", "1"),
        (("add", 0, "to"), "world", "to"),
        # Names of alternatives are left out.
        (("sensor", "imu", "force", "site"), "tip", "site"),
        (("function-wrap[x]", "sensor", "dict[str,union]", "imu", "force", "site", "str"), "tip", "site"),
        (("add", 0, "body", "tuple", "pos", "list[int]", 0), "0", "0"),
        # What is missing is looked for as far as it goes.
        (("sensor", "imu", "objtype"), "{type: force, site: tip}", "imu"),
        (("sensor", "gyro"), "imu: {type: force, site: tip}", "sensor"),
        (("add", 7), "- to: world", "add"),
        (("add", -1), "- to: world", "add"),
        (("sensor", 0), "imu: {type: force, site: tip}", "sensor"),
        # The name of an alternative that is a key as well.
        (("sensor", "imu", "type", "site"), "tip", "site"),
    ],
)
def test_locate(tree: Node, path: tuple[str | int, ...], value: str, key: str) -> None:
    assert written(locate(tree, path)) == value
    assert written(locate(tree, path, key=True)) == key


def test_locate_nothing_is_the_root(tree: Node) -> None:
    assert locate(tree, ()) == tree.span
    assert locate(tree, ("nothing", 3)) == tree.span
    assert locate(tree, (), key=True) == tree.span


def test_a_validators_mark_for_keys(tree: Node) -> None:
    assert written(locate(tree, ("sensor", "imu", "[key]"))) == "imu"


def test_to_python(tree: Node) -> None:
    assert to_python(tree) == {
        "sensor": {"imu": {"type": "force", "site": "tip"}, "type": {"site": "a", "objtype": "b"}},
        "add": [{"to": "world", "body": {"pos": [0, 1]}}],
    }


def test_nodes_are_frozen_and_keys_keep_their_order(tree: Node) -> None:
    assert isinstance(tree, Mapping)
    assert list(tree.entries) == ["sensor", "add"]
    added = tree.entries["add"][1]
    assert isinstance(added, Sequence)
    assert isinstance(added.items, tuple)
    with pytest.raises(AttributeError):
        added.items = ()  # type: ignore[misc]
    assert Scalar(1, tree.span, "1", True) == Scalar(1, tree.span, "1", True)


# The table of section 10.3.2 of the YAML 1.2.2 specification, as it is printed there.
CORE_SCHEMA = (
    (r"null|Null|NULL|~", "null"),
    (r"", "null"),
    (r"true|True|TRUE|false|False|FALSE", "bool"),
    (r"[-+]?[0-9]+", "decimal"),
    (r"0o[0-7]+", "octal"),
    (r"0x[0-9a-fA-F]+", "hexadecimal"),
    (r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", "float"),
    (r"[-+]?(\.inf|\.Inf|\.INF)", "infinity"),
    (r"\.nan|\.NaN|\.NAN", "nan"),
)


def reference(text: str) -> object:
    kind = next((kind for pattern, kind in CORE_SCHEMA if re.fullmatch(pattern, text)), "str")
    match kind:
        case "null":
            return None
        case "bool":
            return text.lower() == "true"
        case "decimal":
            return int(text)
        case "octal":
            return int(text[2:], 8)
        case "hexadecimal":
            return int(text[2:], 16)
        case "float":
            return float(text)
        case "infinity":
            return -math.inf if text.startswith("-") else math.inf
        case "nan":
            return math.nan
    return text


def same(a: object, b: object) -> bool:
    return type(a) is type(b) and repr(a) == repr(b)


PLAIN = st.one_of(
    st.from_regex("|".join(f"(?:{pattern})" for pattern, _ in CORE_SCHEMA), fullmatch=True),
    st.text("0123456789+-._eExoabcdfinNA:~", min_size=1, max_size=10),
    st.sampled_from("yes no on off y n Yes NO tRUE nULL nan inf .Nan .iNF".split()),
    st.sampled_from("0b1 1_0 1,5 0x 0o8 0O7 0X1 -0x1 +0o1 + - . ..1 1e5.0".split()),
).filter(lambda text: text.isascii())


@settings(deadline=None, max_examples=300)
@given(PLAIN)
def test_resolve_agrees_with_the_specification(text: str) -> None:
    expected = reference(text)
    if isinstance(expected, float) and math.isinf(expected) and "inf" not in text.lower():
        with pytest.raises(OverflowError):
            resolve(text)
    else:
        assert same(resolve(text), expected)


@settings(deadline=None, max_examples=200)
@given(PLAIN.filter(lambda text: re.fullmatch(r"[0-9A-Za-z+.~][0-9A-Za-z+.~-]*|[-+.][0-9A-Za-z.][\w.]*", text)))
def test_load_agrees_with_the_specification(text: str) -> None:
    expected = reference(text)
    sink = Sink()
    tree = load(f"[{text}]", "r.yaml", sink)
    item = tree.items[0]  # type: ignore[union-attr]
    assert isinstance(item, Scalar)
    assert item.text == text
    assert item.plain
    if not sink.has_errors:
        assert same(item.value, expected)
    else:
        assert [each.code for each in sink.diagnostics] == ["out-of-range"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 0.001),
        ("1e3", 1000.0),
        ("1E+3", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("-0", 0),
        ("-0.0", -0.0),
        ("010", 10),
        ("+7", 7),
        ("0o17", 15),
        ("0x1F", 31),
        ("12:30", "12:30"),
        ("1_000", "1_000"),
        ("no", "no"),
        ("on", "on"),
        ("yes", "yes"),
        ("y", "y"),
        ("2001-01-01", "2001-01-01"),
        ("=", "="),
        ("٣", "٣"),  # digits of other scripts are text
        ("1e", "1e"),
        ("0b11", "0b11"),
        ("-0x1", "-0x1"),
        ("90deg", "90deg"),
        ("${x}", "${x}"),
    ],
)
def test_values_where_yaml_1_1_and_1_2_differ(text: str, value: object) -> None:
    assert same(resolve(text), value)


def test_numbers_too_large_to_hold() -> None:
    assert resolve("9" * 308) == int("9" * 308)
    for text in ("9" * 309, "9" * 5000, "0x" + "f" * 1001, "1e400", "-1e999"):
        with pytest.raises(OverflowError):
            resolve(text)
