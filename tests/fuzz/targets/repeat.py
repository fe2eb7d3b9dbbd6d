"""Repetition: a recipe with `for` and tables gives the same model as the recipe with all entries written out.

A case is a recipe in which entries are repeated, with the names `turn` and `other`. The check builds it, and the recipe in
which Python has written the entries: both give the same model, or the same errors.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any

import yaml
from fuzz.target import RECIPES, Seed, Target, Tools, without_a_place
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

_ROWS = {"a": {"x": 0.5, "name": "left"}, "b": {"x": 2, "name": "right"}, "c": {"x": -0.25, "name": "middle"}}
_LIST = ["p", "q"]
_PARAMS = {"fuzz_rows": {"type": "table", "default": _ROWS}, "fuzz_list": {"type": "list", "default": _LIST}}
_VALUES: dict[str, list[Any]] = {"${fuzz_rows}": [*_ROWS], "${fuzz_list}": _LIST, "3": [0, 1, 2], "1": [0]}
_FORMS = ("${fuzz_rows[turn].x}", "${fuzz_rows[turn]['x']}", "${[fuzz_rows[turn].x, 7][0]}")
_OF_ELEMENTS = ("${value + fuzz_rows[turn].x}", "${fuzz_rows[turn].x * value - index}")
_NAMED = ("sensor", "actuator", "attach", "equality", "tendon", "check", "keyframe")
_ADDED = {
    "to": "world",
    "body": {"name": "fuzz", "pos": [0, 0, 3.0], "geom": {"name": "fuzz", "size": [0.1]}, "site": {"name": "fuzz"}},
}
_EDIT = {"select": {"body": "**"}, "optional": True, "set": {"gravcomp": 0.5}}
_SENSOR = {"type": "clock", "cutoff": 1.0}


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    for path in [*RECIPES.glob("*.yaml"), *RECIPES.glob("patches/*.yaml")]:
        if "menagerie" not in path.read_text(encoding="utf-8"):
            yield Seed(path.read_bytes())


def _mutate(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    tree = _read(data)
    if tree is None or not isinstance(tree.setdefault("params", {}), dict):
        return data
    tree["params"].update(deepcopy(_PARAMS))
    tree.setdefault("add", []).append(deepcopy(_ADDED))
    tree.setdefault("edit", []).append(deepcopy(_EDIT))
    sensors = tree.setdefault("sensor", {})
    if not isinstance(sensors, dict):
        return data
    sensors["fuzz"] = dict(_SENSOR)
    for _ in range(random.randint(1, 3)):
        section = random.choice(["add", "edit", *(name for name in _NAMED if isinstance(tree.get(name), dict))])
        entries = tree[section]
        keys = [
            key
            for key in (entries if isinstance(entries, dict) else range(len(entries)))
            if isinstance(entries[key], dict) and entries[key].keys().isdisjoint(("for", "when"))
        ]
        if not keys:
            continue
        key = random.choice(keys)
        entry = entries[key]
        values = {"turn": "${fuzz_rows}"}
        if random.random() < 0.4:
            values["other"] = random.choice([*_VALUES])
        suffix = "".join(f"_${{{name}}}" for name in values)
        _vary(entry, suffix, random, _OF_ELEMENTS if section == "edit" else _FORMS)
        entry["for"] = {name: int(each) if each.isdigit() else each for name, each in values.items()}
        if random.random() < 0.3:
            entry["when"] = random.choice(("${turn != 'b'}", "${fuzz_rows[turn].x > 0}", "${turn == 'c'}"))
        if isinstance(entries, dict):
            tree[section] = {f"{name}{suffix}" if name == key else name: each for name, each in entries.items()}
    return yaml.safe_dump(tree, sort_keys=False).encode()


def _vary(tree: Any, suffix: str, random: Random, forms: Sequence[str]) -> None:
    """Give the elements in an entry names of their turn, and compute some of its numbers."""
    for key, each in list(tree.items() if isinstance(tree, dict) else enumerate(tree)):
        if isinstance(each, dict | list):
            if key not in ("select", "id", "for"):
                _vary(each, suffix, random, forms)
        elif key == "name" and isinstance(each, str):
            tree[key] = each + suffix
        elif isinstance(each, float) and random.random() < 0.4:
            tree[key] = random.choice(forms)


def _read(data: bytes) -> dict[str, Any] | None:
    try:
        tree = yaml.safe_load(data)
    except (yaml.YAMLError, UnicodeError, ValueError, RecursionError):
        return None
    lists = ("edit", "add")
    return tree if isinstance(tree, dict) and all(isinstance(tree.get(name, []), list) for name in lists) else None


def _written(tree: dict[str, Any]) -> dict[str, Any]:
    """Return the recipe with its entries written out."""
    found: dict[str, Any] = {}
    for section, entries in tree.items():
        if section in ("add", "edit"):
            found[section] = [made for entry in entries for _, made in _turns("", entry)]
        elif section in _NAMED and isinstance(entries, dict):
            found[section] = {own: made for key, entry in entries.items() for own, made in _turns(key, entry)}
        else:
            found[section] = entries
    return found


def _turns(key: str, entry: Any) -> Iterator[tuple[str, Any]]:
    if not isinstance(entry, dict) or "turn" not in entry.get("for", ()):  # a recipe may have a `for` of its own
        yield key, entry
        return
    values = [_VALUES[str(each)] for each in entry["for"].values()]
    rest = {name: each for name, each in entry.items() if name not in ("for", "when", "id")}
    for turn in itertools.product(*values):
        scope = dict(zip(entry["for"], turn, strict=True))
        if _holds(entry.get("when"), scope):
            yield _said(key, scope), _said(rest, scope)


def _holds(when: str | None, scope: dict[str, Any]) -> bool:
    x = _ROWS[scope["turn"]]["x"]
    return {
        None: True,
        "${turn != 'b'}": scope["turn"] != "b",
        "${fuzz_rows[turn].x > 0}": float(str(x)) > 0,
        "${turn == 'c'}": scope["turn"] == "c",
    }[when]


def _said(tree: Any, scope: dict[str, Any]) -> Any:
    """Return a tree with the values of a turn in place of the expressions that the mutation writes."""
    if isinstance(tree, dict):
        return {_said(key, scope): _said(each, scope) for key, each in tree.items()}
    if isinstance(tree, list):
        return [_said(each, scope) for each in tree]
    if not isinstance(tree, str):
        return tree
    row = _ROWS[scope["turn"]]
    if tree in _FORMS:
        return row["x"]
    for name, value in scope.items():
        tree = tree.replace(f"${{{name}}}", str(value))
    number = str(row["x"]) if float(str(row["x"])) >= 0 else f"({row['x']})"
    return tree.replace("fuzz_rows[turn].x", number)


def _outcome(path: Path, tools: Tools) -> tuple[bytes | None, set[str], Context]:
    context = Context(environment={}, folder=path.parent)
    built = build(ModelRequest(path, verified=False), context, session=tools.session)
    codes = {each.code for each in context.sink.errors}
    return (None if built is None else built.bundle.files["model.xml"]), codes, context


def check(path: Path, tools: Tools) -> str | None:
    tree = _read(path.read_bytes())
    if tree is None or not isinstance(tree.get("params"), dict) or "fuzz_rows" not in tree["params"]:
        return None
    model, codes, context = _outcome(path, tools)
    literal = path.with_name(f"literal_{path.name}")
    literal.write_text(yaml.safe_dump({"name": path.stem, **_written(tree)}, sort_keys=False), encoding="utf-8")
    try:
        other, others, _ = _outcome(literal, tools)
    finally:
        literal.unlink()
    if (model is None) != (other is None):
        return f"one-is-refused-{'-'.join(sorted(codes ^ others))}"
    if model != other:
        return "another-model"
    return without_a_place(context)


TARGET = Target("repeat", ".yaml", _seeds, _mutate, check, RECIPES)
