"""`mjcompose.dumps`: data of Python as a recipe's text, judged by the reader of recipes and by `fmt`."""

from __future__ import annotations

import math
from collections import OrderedDict, deque, namedtuple
from collections.abc import Iterator, Mapping
from enum import Enum, IntEnum
from fractions import Fraction
from pathlib import Path, PureWindowsPath
from types import MappingProxyType
from typing import Any

import mjcompose
import numpy as np
import pytest
import yaml
from hypothesis import example, given, settings, strategies as st
from mjcompose.base.limits import allow
from mjcompose.base.sink import Sink
from mjcompose.text.layout import format_recipe
from mjcompose.text.load import load
from mjcompose.text.node import to_python

ROOT = Path(__file__).resolve().parents[2]


def read(text: str | bytes) -> Any:
    """The data of a text, in which there is no fault."""
    sink = Sink()
    node = load(text, "recipe.yaml", sink)
    assert node is not None and not sink.diagnostics
    return to_python(node)


def written(recipe: Mapping[str, Any]) -> str:
    """The text of a recipe, which is its own layout."""
    text = mjcompose.dumps(recipe)
    assert format_recipe(text.encode(), "recipe.yaml", Sink()) == text.encode()
    return text


def is_same(one: Any, other: Any) -> bool:
    """Whether two values are equal, with their types: `1` is not `1.0`, and `0.0` is not `-0.0`."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(is_same(value, other[key]) for key, value in one.items())
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(is_same, one, other))
    return type(one) is type(other) and repr(one) == repr(other)


def has_nan(value: Any) -> bool:
    if isinstance(value, dict | list):
        return any(map(has_nan, value.values() if isinstance(value, dict) else value))
    return isinstance(value, float) and math.isnan(value)


RECIPES = sorted(path for folder in ("recipes", "docs/examples", "tests") for path in (ROOT / folder).rglob("*.yaml"))


def test_every_recipe_of_the_repository_comes_back() -> None:
    count = 0
    for path in RECIPES:
        sink = Sink()
        node = load(path.read_bytes(), path.name, sink)
        data = None if node is None or sink.diagnostics else to_python(node)
        if not isinstance(data, dict) or has_nan(data):
            continue
        count += 1
        text = written(data)
        assert is_same(read(text), data), path
        assert written(read(text)) == text, path
    assert count > 200


def test_is_laid_out_as_people_write_it() -> None:
    recipe = {
        "attach": {
            "arm": {"site": "place", "model": "./arm.xml"},
            "hand": {
                "model": "./hand.xml",
                "edit": [
                    {"select": {"geom": f"finger{index}_*"}, "set": {"friction": [1, 0.005, 0.0001]}}
                    for index in (1, 2)
                ],
            },
        },
        "add": [{"to": "world", "xml": "<geom>\n\n  <plugin/>\n</geom>\n"}, {"to": "arm", "site": {}}],
        "option": {"timestep": 1e-5, "cone": "elliptic"},
        "recipe": 1,
    }
    assert (
        written(recipe)
        == """\
recipe: 1
attach:
  arm: {model: ./arm.xml, site: place}
  hand:
    model: ./hand.xml
    edit:
      - {select: {geom: "finger1_*"}, set: {friction: [1, 0.005, 0.0001]}}
      - {select: {geom: "finger2_*"}, set: {friction: [1, 0.005, 0.0001]}}
option: {timestep: 1e-05, cone: elliptic}
add:
  - to: world
    xml: |
      <geom>

        <plugin/>
      </geom>
  - {to: arm, site: {}}
"""
    )


def test_nothing_is_empty_brackets() -> None:
    assert written({}) == "{}\n"
    assert read(written({"attach": {}, "add": [], "name": ""})) == {"name": "", "attach": {}, "add": []}


class Kind(str, Enum):  # noqa: UP042  # older programs have these
    BOX = "box"


class Count(IntEnum):
    TWO = 2


Point = namedtuple("Point", "x y")
VALUES = [
    (np.float64(0.1), 0.1),
    (np.float32(0.5), 0.5),
    (np.int8(-3), -3),
    (np.bool_(True), True),
    (np.str_("a b"), "a b"),
    (np.longdouble(0.5), 0.5),
    (np.array([0.25, 2], dtype=np.longdouble), [0.25, 2.0]),
    (np.ma.array([1, 2]), [1, 2]),
    (np.array([[1, 2], [3, 4]]), [[1, 2], [3, 4]]),
    (np.array(2.5), 2.5),
    (np.array([]), []),
    (np.linspace(0, 1, 3), [0.0, 0.5, 1.0]),
    ((1, (2.0, "x")), [1, [2.0, "x"]]),
    (Point(1, 2), [1, 2]),
    (range(3), [0, 1, 2]),
    (deque([1]), [1]),
    (Path("models/arm.xml"), "models/arm.xml"),
    (PureWindowsPath(r"models\arm.xml"), "models/arm.xml"),
    (OrderedDict(b=1, a=2), {"b": 1, "a": 2}),
    (MappingProxyType({"a": None}), {"a": None}),
    (Kind.BOX, "box"),
    (Count.TWO, 2),
    (float("inf"), float("inf")),
    (float("-inf"), float("-inf")),
    (2**70, 2**70),
    (-0.0, -0.0),
]


@pytest.mark.parametrize(
    ("value", "plain"), VALUES, ids=[f"{type(value).__name__}-{value!r:.20}" for value, _ in VALUES]
)
def test_values_of_python_become_plain(value: Any, plain: Any) -> None:
    assert is_same(read(written({"recipe": {"value": value}})), {"recipe": {"value": plain}})


REFUSED = [
    (float("nan"), "recipe['a'][1] is nan, which is not a number"),
    (np.float32("nan"), "recipe['a'][1] is nan, which is not a number"),
    (np.array([0, np.nan]), "recipe['a'][1][1] is nan, which is not a number"),
    (object(), "recipe['a'][1] is of type `object`; a recipe has no such values"),
    ({1, 2}, "recipe['a'][1] is of type `set`; a recipe has no such values"),
    (b"x", "recipe['a'][1] is of type `bytes`; a recipe has no such values"),
    (memoryview(b"x"), "recipe['a'][1] is of type `memoryview`; a recipe has no such values"),
    (1j, "recipe['a'][1] is of type `complex`; a recipe has no such values"),
    (Fraction(1, 3), "recipe['a'][1] is of type `Fraction`; a recipe has no such values"),
    (iter([1]), "recipe['a'][1] is of type `list_iterator`; a recipe has no such values"),
    (np.array([object()]), "recipe['a'][1][0] is of type `object`; a recipe has no such values"),
    (np.clongdouble(1), "recipe['a'][1] is of type `clongdouble`; a recipe has no such values"),
    (np.timedelta64(5, "ns"), "recipe['a'][1] is of type `timedelta64`; a recipe has no such values"),
    (np.array([5], "M8[ns]"), "recipe['a'][1] is of type `ndarray`; a recipe has no such values"),
    (np.zeros(2, [("x", float)]), "recipe['a'][1] is of type `ndarray`; a recipe has no such values"),
    (np.ma.array([1, 2], mask=[0, 1]), "recipe['a'][1] has masked values; a recipe has no such values"),
    (np.ma.masked, "recipe['a'][1] has masked values; a recipe has no such values"),
    ({"x": {2: 1}}, "a key of recipe['a'][1]['x'] must be text, got 2"),
    ({None: 1}, "a key of recipe['a'][1] must be text, got None"),
    ({"k" * 2000: 1}, "a key of recipe['a'][1] has more than 1024 characters"),
    (10**400, "recipe['a'][1] is a number that is too large"),
    (-(10**5000), "recipe['a'][1] is a number that is too large"),
    ("\ud800", "recipe['a'][1] has half of a surrogate pair, which is not a character"),
]


@pytest.mark.parametrize(("value", "message"), REFUSED, ids=[message[:60] for _, message in REFUSED])
def test_what_yaml_has_no_value_for_is_a_type_error_with_its_place(value: Any, message: str) -> None:
    with pytest.raises(TypeError) as caught:
        mjcompose.dumps({"a": [0, value]})
    assert str(caught.value) == message


@pytest.mark.parametrize("recipe", [[1], "recipe: 1\n", None, 1, np.array([1])], ids=repr)
def test_a_recipe_is_a_mapping(recipe: Any) -> None:
    with pytest.raises(TypeError, match="a recipe is a mapping, got"):
        mjcompose.dumps(recipe)


def test_what_contains_itself_is_refused() -> None:
    recipe: dict[str, Any] = {"attach": {"arm": {"edit": [{}]}}}
    recipe["attach"]["arm"]["edit"][0]["set"] = recipe["attach"]
    with pytest.raises(TypeError, match=r"^recipe\['attach'\]\['arm'\]\['edit'\]\[0\]\['set'\] contains itself$"):
        mjcompose.dumps(recipe)
    items: list[Any] = []
    items.append((items,))
    with pytest.raises(TypeError, match=r"^recipe\['a'\]\[0\]\[0\] contains itself$"):
        mjcompose.dumps({"a": items})


def test_what_is_shared_is_written_at_each_place() -> None:
    pose = {"pos": [0, 0, 1]}
    assert read(written({"a": pose, "b": [pose, pose]})) == {"a": pose, "b": [pose, pose]}


def nested(depth: int) -> dict[str, Any]:
    recipe: dict[str, Any] = {}
    for _ in range(depth):
        recipe = {"a": recipe}
    return recipe


def test_depth_has_the_limit_of_files() -> None:
    assert read(written(nested(99))) == nested(99)
    with pytest.raises(mjcompose.MjcomposeError, match=r"yaml-too-deep.*recipe(\['a'\]){8}… has more than 100 lists"):
        mjcompose.dumps(nested(5000))
    with allow(yaml_depth=110):
        assert mjcompose.dumps(nested(105))


class Endless(Mapping[str, Any]):
    def __getitem__(self, key: str) -> Any:
        return 1

    def __iter__(self) -> Iterator[str]:
        number = 0
        while True:
            number += 1
            yield f"a{number}"

    def __len__(self) -> int:
        return 1


def doubled() -> dict[str, Any]:
    """Two to the power of 60 values in 60 lists."""
    value: Any = 1
    for _ in range(60):
        value = [value, value]
    return {"a": value}


@pytest.mark.parametrize(
    "recipe",
    [doubled(), Endless(), {"a": range(10**12)}, {"a": np.broadcast_to(0, (10**6, 10**6))}],
    ids=["doubled", "endless", "range", "array"],
)
def test_the_number_of_values_has_the_limit_of_files(recipe: Mapping[str, Any]) -> None:
    with allow(yaml_values=1000), pytest.raises(mjcompose.MjcomposeError, match="more than 1000 values in `recipe`"):
        mjcompose.dumps(recipe)


WORDS = ["no", "on", "12:30", "1_000", "2026-11-28", "0o17", "~", "1e-3", "=", "<<", "null", ".inf", "0x1F"]


@pytest.mark.parametrize("word", WORDS)
def test_text_is_text_for_other_readers_too(word: str) -> None:
    text = written({"name": word, "attach": {word: {"model": word}}})
    assert yaml.safe_load(text) == read(text) == {"name": word, "attach": {word: {"model": word}}}


@pytest.mark.parametrize("digits", ["9" * 400, "-" + "9" * 400, "1e999", "0x" + "f" * 400])
def test_text_that_looks_like_a_number_that_is_too_large(digits: str) -> None:
    assert read(written({"name": digits, digits: {}})) == {"name": digits, digits: {}}


TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
TEXTS |= st.text("ab \n\t\r:#-.'\"{}[]\\|>", max_size=10)
TEXTS |= st.sampled_from(
    [
        *WORDS,
        "${x}",
        "...",
        "---x",
        "- a",
        "a: b",
        "",
        "é\n ü",
        "1e999",
        "9" * 400,
        "\x7f",
        "\u2028a\nb",
        "\ufeff",
        "a\n\n",
    ]
)
KEYS = TEXTS | st.sampled_from(["recipe", "name", "attach", "model", "site", "add", "to", "xml", "edit", "select"])
NUMBERS = st.integers(-(2**80), 2**80) | st.floats(allow_nan=False)
DATA = st.recursive(
    st.none() | st.booleans() | NUMBERS | TEXTS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=25,
)


@settings(max_examples=300, deadline=None)
@given(st.dictionaries(KEYS, DATA, max_size=5))
@example({"a": "x\n y\n", "b": [[["x\ny"]]], "c": {"d": ["\ta\nb"]}})
def test_every_mapping_comes_back(recipe: dict[str, Any]) -> None:
    assert is_same(read(written(recipe)), recipe)


def test_the_room_on_a_line_is_looked_at_once() -> None:
    """The work on a long nested list grows with its length, and not with its depth times its length."""
    from mjcompose.text import dump

    counts = []
    for length in (200, 400):
        value: Any = [0] * length
        for _ in range(20):
            value = [value, 0]
        scalars = 0
        scalar = dump._scalar

        def counted(data: Any, scalar: Any = scalar) -> str:
            nonlocal scalars
            scalars += 1
            return scalar(data)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(dump, "_scalar", counted)
            mjcompose.dumps({"a": value})
        counts.append(scalars)
    assert counts[1] < 2.2 * counts[0] < 200 * 10
