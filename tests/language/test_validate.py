"""Wrong recipes, each a case in `errors/` with what is told; set `UPDATE_EXPECTED=1` to write that anew."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from cases import Case, cases, uncounted
from language.validating import validate
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.report import render
from mjcompose.base.sink import Sink
from mjcompose.language.expand import expand
from mjcompose.language.recipe import Recipe
from mjcompose.language.validate import faults, validate_what_remains
from mjcompose.plan.read import read_recipe
from mjcompose.sources.context import Context
from mjcompose.text.load import load
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, to_python
from pydantic import ValidationError


def test_related_places_are_moved_with_their_fault() -> None:
    data = {"recipe": 1, "attach": {"a": {"model": "m", "site": "s", "body": "b"}}}
    try:
        Recipe.model_validate(data)
    except ValidationError as error:
        (fault,) = faults(error, data)
    assert fault.at == ("attach", "a", "body")
    assert fault.related[0][1] == ("attach", "a", "site")


WRONG = """
recipe: 1
base: ./arm.xml
attach:
  left: {model: ./hand.xml, sight: flange}
  right: {model: ./hand.xml, site: flange}
add:
  - {to: world, body: {name: cup, poss: 1 2 3}}
  - {to: world}
  - {to: world, body: {name: plate, pos: [0, 0, 1]}}
sensor:
  touch: {site: flange}
  force: {type: force, site: flange}
"""


def remaining(text: str) -> tuple[object, frozenset[str]] | None:
    node = load(text, "recipe.yaml", Sink())
    assert node is not None
    found = validate_what_remains(node, sink := Sink())
    assert sink.has_errors or found is not None
    return (to_python(found.document), found.lost) if found is not None else None


def test_the_smallest_piece_is_left_out() -> None:
    found = remaining(WRONG)
    assert found is not None
    document, lost = found
    assert document == {
        "recipe": 1,
        "base": "./arm.xml",
        "attach": {"left": {"model": "./hand.xml"}, "right": {"model": "./hand.xml", "site": "flange"}},
        "add": [{"to": "world", "body": {"name": "cup"}}, {"to": "world", "body": {"name": "plate", "pos": [0, 0, 1]}}],
        "sensor": {"force": {"type": "force", "site": "flange"}},
    }
    assert {"sight", "poss", "touch"} <= lost


def test_a_right_recipe_remains_whole() -> None:
    assert remaining("recipe: 1\nbase: ./arm.xml\n") == ({"recipe": 1, "base": "./arm.xml"}, frozenset())


def test_without_base_version_or_separator_nothing_can_be_judged() -> None:
    assert remaining("recipe: 2\nbase: ./arm.xml\n") is None
    assert remaining("recipe: 1\nbase: [1]\n") is None
    assert remaining("recipe: 1\nseparator: '#'\n") is None


def test_nothing_remains_without_the_base_however_it_is_spelt() -> None:
    assert remaining("recipe: 1\nbsae: ./arm.xml\nadd: []\n") is None
    assert remaining("recipe: 1\ncolor: ./arm.xml\nadd: []\n") is not None


def test_two_faults_in_a_part_of_which_one_takes_all_of_it() -> None:
    found = remaining("recipe: 1\nattach:\n  hand: {model: 1, subtree: [hand]}\n")
    assert found is not None and found[0] == {"recipe": 1, "attach": {}}


CASES = cases(Path(__file__).parent / "errors")
RECIPES = sorted(Path(__file__).parents[2].joinpath("recipes").glob("*.yaml"))
PLACE = Span("recipe.yaml", 1, 1, 1, 2)


def parse(text: str, sink: Sink) -> Node:
    node = load(text, "recipe.yaml", sink)
    assert node is not None
    return node


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.path.stem)
def test_wrong_recipe(case: Case) -> None:
    text = case.texts["recipe.yaml"]
    sink = Sink()
    assert validate(parse(text, sink), sink) is None
    told = uncounted("\n\n".join(render(each, lambda _: text) for each in sink.sorted()) + "\n")
    assert told == case.check(told)


def test_there_are_wrong_recipes() -> None:
    assert len(CASES) >= 67


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.name)
def test_shipped_recipe(path: Path) -> None:
    sink = Sink()
    context = Context(folder=path.parent, sink=sink)
    node = read_recipe(path, context)
    assert isinstance(node, Mapping)
    recipe = validate(expand(node, {}, sink).document, sink)
    assert not sink.diagnostics
    assert isinstance(recipe, Recipe)


def test_typing_error_in_a_required_key_is_one_error(faults: Callable[[str], list[Diagnostic]]) -> None:
    (fault,) = faults("attach: {gripper: {modle: ./gripper.xml}}")
    assert (fault.code, fault.help) == ("unknown-key", "write `model`")
    assert fault.span is not None
    assert (fault.span.line, fault.span.column, fault.span.end_column) == (2, 20, 25)


def test_other_unknown_key_does_not_hide_a_missing_one(faults: Callable[[str], list[Diagnostic]]) -> None:
    found = faults("attach: {gripper: {weight: 3}}")
    assert [fault.code for fault in found] == ["missing-key", "unknown-key"]


def test_null_is_told_once(faults: Callable[[str], list[Diagnostic]]) -> None:
    assert [fault.message for fault in faults("name:\noption: {gravity: [0, null, 1]}")] == [
        "`name` has no value",
        "a value is missing here",
    ]


@pytest.mark.parametrize(
    "text", ["base: [null]", "attach: {a: [null]}", "sensor: {a: [null]}", "attach: [null, {b: null}]"]
)
def test_nothing_in_a_list_where_none_is_expected_is_told_once(
    faults: Callable[[str], list[Diagnostic]], text: str
) -> None:
    (fault,) = faults(text)
    assert "expects a mapping" in fault.message


def test_unknown_key_without_value_is_unknown(faults: Callable[[str], list[Diagnostic]]) -> None:
    assert [fault.code for fault in faults("sensors:\n")] == ["unknown-key"]


def test_wrong_version_is_told_alone(faults: Callable[[str], list[Diagnostic]]) -> None:
    sink = Sink()
    assert validate(parse("recipe: 3\nfoo: 1\noption: {cone: 1}\n", sink), sink) is None
    assert [each.code for each in sink.diagnostics] == ["recipe-version"]


@pytest.mark.parametrize("version", ["1.0", "true", "'1'", "[1]", "0"])
def test_only_the_integer_is_the_version(version: str) -> None:
    sink = Sink()
    assert validate(parse(f"recipe: {version}\n", sink), sink) is None
    assert [each.code for each in sink.diagnostics] == ["recipe-version"]


@pytest.mark.parametrize("text", ["- 1", "text", "3"])
def test_no_mapping(text: str) -> None:
    sink = Sink()
    assert validate(parse(text, sink), sink) is None
    assert [each.code for each in sink.diagnostics] == ["wrong-type"]


JUNK = (
    *(None, True, 0, -1, 1.5, float("nan"), float("inf"), 10**400, "", "x", "${a}", "90deg", "<geom/>"),
    *("world", "base", "\x01", [], {}, [None], [[]], [{}], [1, 2, 3]),
    *({"x": 1}, {"xml": "<a/>"}, {"xml": 1}, {"type": "free"}, {"type": []}, {"": {}}, {"frame": None}),
    *({"config": {"a": [[1]]}}, {"path": [{"site": []}]}, {"pulley": {}}),
)
KEYS = ("xml", "type", "name", "path", "config", "base", "", "a/b", "${x}", "site", "parent", "when", "edit")


def changed(value: Any, chance: random.Random) -> Any:
    """The value with some of what is in it replaced, renamed, added or left out."""
    if chance.random() < 0.06:
        return chance.choice(JUNK)
    if isinstance(value, list):
        return [changed(item, chance) for item in value]
    if not isinstance(value, dict):
        return value
    result = {
        chance.choice(KEYS) if chance.random() < 0.05 else name: changed(item, chance)
        for name, item in value.items()
        if chance.random() > 0.05
    }
    return result | ({chance.choice(KEYS): chance.choice(JUNK)} if chance.random() < 0.08 else {})


def located(value: Any) -> Node:
    """A value as a tree whose places all are the same."""
    if isinstance(value, dict):
        return Mapping({name: (Key(name, PLACE), located(item)) for name, item in value.items()}, PLACE)
    if isinstance(value, list):
        return Sequence(tuple(located(item) for item in value), PLACE)
    return Scalar(value, PLACE, str(value), True)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_written_becomes_diagnostics(seed: int) -> None:
    chance = random.Random(seed)
    texts = [path.read_text(encoding="utf-8") for path in RECIPES]
    texts += [case.texts["recipe.yaml"] for case in CASES]
    values = [to_python(parse(text, Sink())) for text in texts]
    for _ in range(250):
        value = changed(chance.choice(values), chance)
        sink = Sink()
        recipe = validate(located(value), sink)
        assert (recipe is None) == sink.has_errors, value
        assert all(each.span is not None for each in sink.diagnostics), value
