"""The JSON Schema of recipes, for editors.

`python -m composer.recipe.schema > schemas/recipe.schema.json` writes it.
"""

from __future__ import annotations

import ast
import inspect
import json
import sys
import textwrap
from collections.abc import Iterator
from typing import Any

from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.model import Model
from composer.recipe.randomize import Randomize
from composer.recipe.recipe import Recipe
from composer.recipe.reference import REFERENCE, Schema, define, definition_key
from composer.recipe.urdf_keys import UrdfKeys
from composer.recipe.variation_schema import add_variation

DIALECT = "https://json-schema.org/draft/2020-12/schema"
MODELS: tuple[type[Model], ...] = (Recipe, Attachment, Base, Randomize, UrdfKeys)
WIDTH = 110

_ORDER = (
    "$schema title description markdownDescription $ref type const enum default properties "
    "additionalProperties required"
)
_RANK = {key: rank for rank, key in enumerate(_ORDER.split())} | {"$defs": 1000}
# Keys of JSON Schema whose mappings have names as keys.
_NAMES = frozenset({"properties", "patternProperties", "$defs"})


def recipe_schema() -> Schema:
    """Return the schema of a whole recipe, as JSON Schema 2020-12. It is the same every time."""
    schema = Recipe.model_json_schema()
    definitions: dict[str, Schema] = schema.pop("$defs")
    for model in MODELS:
        target = schema if model is Recipe else definitions[model.__name__]
        _describe(model, target.get("properties") or target["anyOf"][-1]["properties"])
    schema = _tidy(schema)
    definitions = {name: _tidy(each) for name, each in definitions.items()}
    needed = definitions[Attachment.__name__].pop("required")
    definitions[Attachment.__name__]["allOf"].append({"required": needed})  # as in `element_schema`
    _complete(schema, definitions)
    add_variation(schema, definitions)
    # No title: editors would show it before every description.
    head = {"$schema": DIALECT, "description": "A recipe of mjcompose: what a MuJoCo model is made of."}
    whole = {**schema, **head, "$defs": dict(sorted(definitions.items()))}
    for each in _mappings(whole):
        description = each.get("description")
        if isinstance(description, str) and "`" in description:
            each["markdownDescription"] = description  # else editors show the marks
    return whole


def text() -> str:
    """Return the schema as the text of its file. Short values are on one line, so that changes can be read."""
    return _layout(recipe_schema(), "", in_order=True) + "\n"


def _complete(schema: Any, definitions: dict[str, Schema]) -> None:
    """Replace references by `$ref`, and add the definitions that they lead to."""
    waiting = [schema, *definitions.values()]
    while waiting:
        for each in list(_mappings(waiting.pop())):
            if REFERENCE not in each:
                continue
            name = each.pop(REFERENCE)
            key = definition_key(name)
            each["$ref"] = f"#/$defs/{key}"
            if key not in definitions:
                definitions[key] = define(name)
                waiting.append(definitions[key])


def _mappings(value: Any) -> Iterator[Schema]:
    if isinstance(value, dict):
        yield value
        for each in list(value.values()):
            yield from _mappings(each)
    elif isinstance(value, list):
        for each in value:
            yield from _mappings(each)


def _tidy(schema: Any, properties: bool = False) -> Any:
    """Return the schema without pydantic's titles, and without null, which is not a value in a recipe."""
    if isinstance(schema, list):
        return [_tidy(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    if properties:
        return {name: _tidy(each) for name, each in schema.items()}
    tidy = {key: _tidy(each, key == "properties") for key, each in schema.items() if key != "title"}
    if tidy.get("default", ...) in (None, [], {}):
        del tidy["default"]
    alternatives = [each for each in tidy.get("anyOf", ()) if each != {"type": "null"}]
    if len(alternatives) == 1:
        del tidy["anyOf"]
        tidy = {**alternatives[0], **tidy}
    return tidy


def _describe(model: type[Model], properties: dict[str, Schema]) -> None:
    """Use the text below each field of a model as the description of its key, also for inherited fields."""
    for each in reversed(model.__mro__[: model.__mro__.index(Model)]):
        for field, text in _texts(each):
            properties[model.model_fields[field].alias or field]["description"] = text


def _texts(model: type) -> Iterator[tuple[str, str]]:
    """Yield the fields that a class itself declares, each with the text below it."""
    (body,) = ast.parse(textwrap.dedent(inspect.getsource(model))).body
    assert isinstance(body, ast.ClassDef)
    for field, text in zip(body.body, body.body[1:], strict=False):
        if (
            isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
        ):
            yield field.target.id, inspect.cleandoc(str(text.value.value))


def _layout(value: Any, indent: str, in_order: bool) -> str:
    """Return JSON text. With `in_order`, the keys are JSON Schema's own and are written in a fixed order."""
    compact = json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict) and in_order:
        value = dict(sorted(value.items(), key=lambda item: _RANK.get(item[0], 100)))
        compact = json.dumps(value, ensure_ascii=False)
    if not isinstance(value, dict | list) or len(indent) + len(compact) <= WIDTH:
        return compact
    inner = indent + " "
    if isinstance(value, list):
        lines = [f"{inner}{_layout(each, inner, in_order=True)}" for each in value]
        return "[\n" + ",\n".join(lines) + f"\n{indent}]"
    lines = [
        f"{inner}{json.dumps(key, ensure_ascii=False)}: {_layout(each, inner, not in_order or key not in _NAMES)}"
        for key, each in value.items()
    ]
    return "{\n" + ",\n".join(lines) + f"\n{indent}}}"


if __name__ == "__main__":
    sys.stdout.write(text())
