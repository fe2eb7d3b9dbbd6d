"""The forms are the only list of the language's keys: reader, JSON Schema, `fmt`, reference and editors derive theirs."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mjcompose.language.forms.context import Lazy
from mjcompose.language.forms.model import Model, rest_of
from mjcompose.language.forms.translate import first_keys, name_scopes, spots
from mjcompose.language.recipe import DEPTHS, SETTLED, Interface, Recipe
from mjcompose.language.reference_page import pages
from mjcompose.lsp.language import forms_at, keys_of
from mjcompose.lsp.places import _rows
from mjcompose.text import key_order

SOURCES = Path(__file__).parents[2] / "composer" / "mjcompose"
PLACES: dict[tuple[Any, ...], type[Model]] = {(): Recipe}
for _each in spots(Recipe):
    if isinstance(_each.kind, type) and issubclass(_each.kind, Model) and _each.kind.key_names():
        PLACES.setdefault(_each.at, _each.kind)
NAMED = {
    ("attach",),
    ("check",),
    ("keyframe",),
    ("params",),
    ("datasheets",),
    ("randomize", "fields"),
    ("identify", "fields"),
}
"""Mappings from names; the items of the others are in lists."""
BESIDE_ELEMENTS = {("contact", "exclude", "*")}
"""Where an element of MJCF can stand as well."""


def of_form(at: tuple[Any, ...]) -> str:
    return ".".join(map(str, at)) or "recipe"


def test_every_form_has_its_place() -> None:
    assert len(PLACES) > 60
    lazy = {name for name, info in Recipe.model_fields.items() if any(isinstance(mark, Lazy) for mark in info.metadata)}
    assert lazy | {"base", "attach", "add", "contact", "edit", "keyframe", "check"} <= {
        str(at[0]) for at in PLACES if at
    } | {
        "variants"  # pieces of recipe
    }


@pytest.mark.parametrize("at", PLACES, ids=of_form)
def test_editors_and_the_schema_have_the_keys_of_the_form(at: tuple[Any, ...]) -> None:
    """Completions and hovers are a walk through the JSON Schema."""
    model = PLACES[at]
    path = tuple(0 if step == "*" and at[:index] not in NAMED else step for index, step in enumerate(at))
    offered = {key.name: key.doc for key in keys_of(forms_at(path))}
    assert {*model.key_names()} <= offered.keys()
    assert all(offered[key] for key in model.key_names())
    assert at in BESIDE_ELEMENTS or rest_of(model) is not None or offered.keys() == {*model.key_names()}


@pytest.mark.parametrize("at", PLACES, ids=of_form)
def test_fmt_writes_the_keys_in_the_order_of_the_form(at: tuple[Any, ...]) -> None:
    path = tuple(map(str, at))
    model = PLACES[at]
    if rest_of(model) is None:
        assert [*key_order.WHOLE[path]] == model.key_names()
    else:
        assert [*key_order.FIRST.get(path, ())] == first_keys(Recipe).get(at, [])


def test_fmt_knows_no_other_mapping() -> None:
    assert key_order.WHOLE.keys() == {tuple(map(str, at)) for at, model in PLACES.items() if rest_of(model) is None}
    assert key_order.FIRST.keys() == {tuple(map(str, at)) for at in first_keys(Recipe)}


def test_editors_complete_the_names_that_the_forms_declare() -> None:
    scopes = name_scopes(Recipe)
    assert {at for at, _ in _rows()} == {*scopes, *(at[:-1] for at in scopes if at[-1] == "*")}


def test_each_key_has_a_row_in_the_reference() -> None:
    rows = "\n".join(pages().values())
    for at, model in PLACES.items():
        missing = [key for key in model.key_names() if f"`{key}`" not in rows and f".{key}`" not in rows]
        assert not missing or rest_of(model) is not None, (at, missing)


def test_items_with_when_are_those_whose_form_has_it() -> None:
    declared = {at[0]: len(at) for at, model in PLACES.items() if "when" in model.key_names() and at[0] != "contact"}
    own = {name: DEPTHS[name] for name in declared if name in DEPTHS and name not in ("base", "attach")}
    assert own == {**dict.fromkeys(("add", "edit", "keyframe", "check"), 2), "interface": 3}
    assert not {*SETTLED} & {*DEPTHS}


def literals(tree: ast.AST) -> Iterator[set[str]]:
    """The texts of each tuple, list, set, mapping and `"…".split()`."""
    for node in ast.walk(tree):
        items = getattr(node, "elts", None) or getattr(node, "keys", None)
        if isinstance(node, ast.Tuple | ast.List | ast.Set | ast.Dict) and items:
            yield {each.value for each in items if isinstance(each, ast.Constant) and isinstance(each.value, str)}
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < 500:
            yield {*node.value.split()}


FUNCTIONS = {"mujoco/fit.py"}
"""The functions of a child process by their names, which are also words of a verb."""


def test_no_module_lists_the_keys_of_a_form() -> None:
    """Only the module that declares a form may name all of its keys again. The keys of an interface are MuJoCo's kinds."""
    forms = {
        frozenset(model.key_names()): model
        for model in PLACES.values()
        if len(model.key_names()) > 3 and model is not Interface
    }
    listed = [
        f"{path.relative_to(SOURCES)} lists the keys of {model.__name__}"
        for path in sorted(SOURCES.rglob("*.py"))
        for found in literals(ast.parse(path.read_text(encoding="utf-8")))
        for keys, model in forms.items()
        if keys <= found
        and not model.__module__.endswith(str(path.with_suffix("").relative_to(SOURCES)).replace("/", "."))
    ]
    assert [each for each in listed if each.partition(" ")[0] not in FUNCTIONS] == []
