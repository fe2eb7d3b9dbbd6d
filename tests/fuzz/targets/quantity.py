"""Quantities: a parameter with a unit, in any place of a recipe, is the same as its value written there.

A case is a recipe in which numbers are `${fuzzed}`, or an expression that gives its value. The check builds it, and the
same recipe with the value in these places: both give the same model, or the same errors.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any

import yaml
from fuzz.target import RECIPES, Seed, Target, Tools, without_a_place
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

_NAME = "fuzzed"
_VALUES = ("30deg", "-0.25rad", "0deg", 0.3)
# Each gives the value to the last bit: halves and doubles do not round.
_FORMS = tuple(
    f"${{{form}}}"
    for form in (
        "fuzzed",
        "-(-fuzzed)",
        "fuzzed * 2 / 2",
        "[0, fuzzed][1]",
        "fuzzed if true else 0",
        "max(fuzzed, 2 * fuzzed) if false else fuzzed",
    )
)
_PLAIN = ("params", "recipe", "matrix", "randomize", "edit")
_EDITS = (
    {"select": {"joint": "**", "where": {"type": "hinge"}}, "optional": True, "set": {"ref": 0.0}},
    {"select": {"joint": "**", "where": {"type": "hinge"}}, "optional": True, "set": {"range": [-1.0, 1.0]}},
    {"select": {"body": "**"}, "optional": True, "set": {"euler": [0.0, 0.0, 0.0]}},
    {"select": {"site": "**"}, "optional": True, "set": {"axisangle": [0.0, 0.0, 1.0, 0.0]}},
    {"select": {"position": "**"}, "optional": True, "set": {"ctrlrange": [-1.0, 1.0]}},
    {"select": {"camera": "**"}, "optional": True, "set": {"fovy": 45.0}},
)  # fmt: skip


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    for path in [*RECIPES.glob("*.yaml"), *RECIPES.glob("patches/*.yaml")]:
        if "menagerie" not in path.read_text(encoding="utf-8"):
            yield Seed(path.read_bytes())


def _mutate(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    tree = _read(data)
    if tree is None:
        return data
    edits = deepcopy(random.sample(_EDITS, random.randint(1, 3)))
    if random.random() < 0.5:
        tree["angle"] = random.choice(("degree", "radian"))
    params = tree.setdefault("params", {})
    if not isinstance(params, dict):
        return data
    params[_NAME] = random.choice(_VALUES)
    # An edit that selects nothing is checked only if its values are written out, so its own numbers stay.
    elsewhere = {name: each for name, each in tree.items() if name not in _PLAIN}
    places = [*_numbers(edits), *(_numbers(elsewhere) if random.random() < 0.2 else ())]
    for holder, key in random.sample(places, min(len(places), random.randint(1, 4))):
        holder[key] = random.choice(_FORMS)
    tree.setdefault("edit", []).extend(edits)
    return yaml.safe_dump(tree, sort_keys=False).encode()


def _read(data: bytes) -> dict[str, Any] | None:
    try:
        tree = yaml.safe_load(data)
    except (yaml.YAMLError, UnicodeError, ValueError, RecursionError):
        return None
    return tree if isinstance(tree, dict) and isinstance(tree.get("edit", []), list) else None


def _numbers(tree: Any) -> Iterator[tuple[Any, Any]]:
    """Yield the places of numbers: each the mapping or list, and the key in it."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in items:
        if isinstance(value, dict | list):
            yield from _numbers(value)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield tree, key


def _written(tree: Any, value: Any) -> Any:
    """Return the recipe with the value in each place that computes it."""
    if isinstance(tree, dict):
        return {key: _written(each, value) for key, each in tree.items()}
    if isinstance(tree, list):
        return [_written(each, value) for each in tree]
    return value if tree in _FORMS else tree


def _outcome(path: Path, tools: Tools) -> tuple[bytes | None, set[str], Context]:
    context = Context(environment={}, folder=path.parent)
    built = build(ModelRequest(path, verified=False), context, session=tools.session)
    codes = {each.code for each in context.sink.errors}
    return (None if built is None else built.bundle.files["model.xml"]), codes, context


def check(path: Path, tools: Tools) -> str | None:
    tree = _read(path.read_bytes())
    value = tree.get("params", {}).get(_NAME) if tree is not None and isinstance(tree.get("params", {}), dict) else None
    if tree is None or value is None:
        return None
    model, codes, context = _outcome(path, tools)
    literal = path.with_name(f"literal_{path.name}")
    literal.write_text(yaml.safe_dump({"name": path.stem, **_written(tree, value)}, sort_keys=False), encoding="utf-8")
    try:
        other, others, _ = _outcome(literal, tools)
    finally:
        literal.unlink()
    if (model is None) != (other is None):
        return f"one-is-refused-{'-'.join(sorted(codes ^ others))}"
    if model != other:
        return "another-model"
    return without_a_place(context)


TARGET = Target("quantity", ".yaml", _seeds, _mutate, check, RECIPES)
