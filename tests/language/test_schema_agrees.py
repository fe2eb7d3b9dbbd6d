"""What the schema and the reader of recipes say of the same recipe, over many that somebody might have mistyped."""

from __future__ import annotations

import copy
import json
import random
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cases import cases
from language.validating import validate
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.sink import Sink
from mjcompose.language.assign import TAGS
from mjcompose.language.expand import expand
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, Sequence, to_python
from mjcompose.tree.pattern import known_tags

ROOT = Path(__file__).parents[2]
RECIPES = [
    path.read_bytes()
    for pattern in ("recipes/**/*.yaml", "tests/golden/*/*.yaml")
    for path in sorted(ROOT.glob(pattern))
] + [
    text.encode()
    for case in cases(ROOT / "tests" / "errors")
    for name, text in case.texts.items()
    if name.endswith(".yaml")
]
# What is judged elsewhere, or by the files that are named.
_NOT_HERE = ("extends", "trust", "variants", "matrix", "recipe")
_VALUES: list[Any] = [
    "a",
    1,
    0,
    -1,
    1.5,
    [0, 0, 1],
    [1, 0, 0, 0],
    "90deg",
    True,
    False,
    "true",
    [],
    {},
    "",
    [1, 2],
    ["a", "b"],
    "0 0 1",
    "**",
    "world",
    [[1, 2, 3]],
    {"a": 1},
    "1",
    [True],
    "main",
    3.0,
    "./x.xml",
    [0.5, "90deg"],
]
# Kinds of fault that a schema can see wherever they are.
_SEEN = ("unknown-key", "unknown-attribute", "unknown-element")


def recipes() -> list[dict[str, Any]]:
    found = []
    for source in RECIPES:
        node = load(source, "recipe.yaml", Sink())
        value = None if node is None else to_python(node)
        if isinstance(value, dict):
            found.append({name: each for name, each in value.items() if name not in _NOT_HERE})
    return [each for each in found if each]


def parts(value: Any) -> Iterator[tuple[str | None, Any]]:
    """Every key with its value, and every item."""
    items = value.items() if isinstance(value, dict) else ((None, item) for item in value)
    for name, each in items:
        yield name, each
        if isinstance(each, dict | list):
            yield from parts(each)


class Mistakes:
    """Makes mistakes, with keys and values that stand elsewhere in recipes."""

    def __init__(self, pool: list[dict[str, Any]], seed: int) -> None:
        self.chance = random.Random(seed)
        self.keys = sorted({name for each in pool for name, _ in parts(each) if name is not None})
        self.values = [value for each in pool for _, value in parts(each)]

    def of(self, value: Any, rate: float) -> Any:
        dice = self.chance.random()
        if isinstance(value, list):
            items = [self.of(item, rate) for item in value if self.chance.random() > rate / 3]
            return items if dice > rate / 10 else self.chance.choice(_VALUES)
        if not isinstance(value, dict):
            return self.chance.choice(_VALUES) if dice < rate else value
        found: dict[str, Any] = {}
        for name, each in value.items():
            dice = self.chance.random() / rate
            if dice < 0.4:
                continue
            key = self.chance.choice(self.keys) if dice < 0.6 else name
            found[key] = copy.deepcopy(self.chance.choice(self.values)) if 0.6 < dice < 0.8 else self.of(each, rate)
        return found


def keys(node: Node) -> Iterator[Any]:
    """The place of every key, but for those of fragments and of `where`, of which a schema knows nothing."""
    if isinstance(node, Mapping):
        for key, value in node.entries.values():
            yield key.span
            yield from keys(value) if key.name != "where" else ()
    if isinstance(node, Sequence):
        for item in node.items:
            yield from keys(item)


def is_rare(fault: Diagnostic) -> bool:
    """Whether it is about an edit of what is seldom edited, whose attributes the schema leaves out."""
    found = re.fullmatch(r"`\S+` is not an attribute of `(\w+)`", fault.message)
    return found is not None and found[1] in known_tags() and found[1] not in TAGS


def is_of_a_table(fault: Diagnostic) -> bool:
    """Whether it is about a column that other rows of a table do not have."""
    return "has no column" in fault.message


def judged(node: Mapping) -> list[Diagnostic]:
    sink = Sink()
    document = expand(node, {}, sink, any=True).document
    validate(document, sink)
    return sink.errors


@pytest.mark.parametrize("seed", range(4))
def test_both_say_the_same(seed: int) -> None:
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    schema = json.loads((ROOT / "schemas" / "recipe.schema.json").read_text(encoding="utf-8"))
    validator = jsonschema.Draft202012Validator(schema)
    pool = recipes()
    mistakes = Mistakes(pool, seed)
    right = wrong = 0
    for _ in range(600):
        recipe = mistakes.chance.choice(pool)
        sections = mistakes.chance.sample(sorted(recipe), min(len(recipe), 2))
        mistaken = mistakes.of({name: recipe[name] for name in sections}, 0.04)
        value = {"recipe": 1, **{name: each for name, each in mistaken.items() if name not in _NOT_HERE}}
        sink = Sink()
        node = load(json.dumps(value), "r.yaml", sink)
        if "${" in json.dumps(value) or not isinstance(node, Mapping) or sink.errors:
            continue
        errors = judged(node)
        if not errors:
            right += 1
            assert validator.is_valid(value), value
            continue
        places = set(keys(node))
        unknown = [
            each
            for each in errors
            if each.code in _SEEN and each.span in places and not is_rare(each) and not is_of_a_table(each)
        ]
        if unknown:
            wrong += 1
            assert not validator.is_valid(value), (unknown[0].message, value)
    assert right > 100
    assert wrong > 20


def values(value: Any, at: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """Yield every text, number and flag of a recipe with its path, and every list of numbers."""
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for step, each in items:
            yield from values(each, (*at, step))
    is_vector = isinstance(value, list) and value and all(type(each) in (int, float) for each in value)
    if is_vector or isinstance(value, str | int | float):
        yield at, value


def with_template(recipe: dict[str, Any], at: tuple[str | int, ...], value: Any) -> dict[str, Any]:
    """Return the section of a value, with a parameter instead of it, and what the section needs."""
    section = copy.deepcopy(recipe[str(at[0])])
    place: Any = {at[0]: section}
    for step in at[:-1]:
        place = place[step]
    place[at[-1]] = "${instead}"
    needs = {name: recipe[name] for name in ("angle", "eulerseq") if name in recipe and name != at[0]}
    params = {**recipe.get("params", {}), "instead": {"default": value}}
    return {"recipe": 1, **needs, "params": params, str(at[0]): section}


def test_a_template_may_stand_where_a_recipe_computes_a_value() -> None:
    """Everything that is read as a value of a parameter is accepted as its `${…}`, once for each kind of place."""
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    schema = json.loads((ROOT / "schemas" / "recipe.schema.json").read_text(encoding="utf-8"))
    validator = jsonschema.Draft202012Validator(schema)
    seen = set()
    accepted = 0
    for recipe in recipes():
        for at, value in values(recipe):
            # Names are of one kind: two elements of a section differ in nothing else.
            kind = (at[0], *("item" if isinstance(step, int) else step for step in at[-2:]), type(value))
            if len(at) < 2 or at[0] == "params" or kind in seen or (isinstance(value, str) and "${" in value):
                continue
            seen.add(kind)
            computed = with_template(recipe, at, value)
            sink = Sink()
            node = load(json.dumps(computed), "r.yaml", sink)
            if isinstance(node, Mapping) and not sink.errors and not judged(node):
                accepted += 1
                assert validator.is_valid(computed), (at, computed)
    assert accepted > 500
