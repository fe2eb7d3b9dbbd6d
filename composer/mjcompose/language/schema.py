"""The JSON Schema of recipes, for editors."""

from __future__ import annotations

import itertools
import json
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

from mjcompose.language.attach import Attachment
from mjcompose.language.forms.context import REFERENCE, Schema, define, definition_key
from mjcompose.language.forms.json_schema import Generator
from mjcompose.language.forms.scalars import FOR, WHEN
from mjcompose.language.parameters import NO_PIECE
from mjcompose.language.placing import OF_A_FILE
from mjcompose.language.recipe import Recipe, sections_of
from mjcompose.language.sections import Singleton

_DEFS = "#/$defs/"
_PIECE = "piece."
_MAPPINGS = ("properties", "patternProperties")
_NESTED = ("anyOf", "oneOf", "allOf", "prefixItems", "additionalProperties", "items", "then", "else", "not")


def loosened(properties: Schema, definitions: dict[str, Schema]) -> Schema:
    """Return the same properties, all optional or null. New definitions go to `definitions`, conditions stay."""
    loose = {name: _optional(each, definitions) for name, each in properties.items()}
    return {name: _nullable(each) for name, each in loose.items()}


def _optional(schema: Any, definitions: dict[str, Schema]) -> Any:
    if isinstance(schema, list):
        return [_optional(each, definitions) for each in schema]
    if not isinstance(schema, dict):
        return schema
    found: Schema = {}
    for key, value in schema.items():
        if key in ("required", "minProperties"):
            continue
        if key == "allOf":  # the owner of a key may be in the recipe that a piece is merged over
            value = [each for each in value if not (isinstance(each, dict) and "not" in each.get("if", {}))]
            if not value:  # a schema has no empty `allOf`
                continue
        if key in _MAPPINGS:
            found[key] = loosened(value, definitions)
        elif key == "additionalProperties" and isinstance(value, dict):
            found[key] = _nullable(_optional(value, definitions))
        elif key in _NESTED:
            found[key] = _optional(value, definitions)
        else:
            found[key] = _reference(value, definitions) if key == "$ref" else value
    return found


def _reference(target: str, definitions: dict[str, Schema]) -> str:
    name = target.removeprefix(_DEFS)
    if not target.startswith(_DEFS) or name == "Piece" or name.startswith(_PIECE):
        return target
    piece = _PIECE + name
    if piece not in definitions:
        definitions[piece] = {}  # for those that refer to themselves
        definitions[piece] = _nullable(_optional(definitions[name], definitions))
    return _DEFS + piece


def _nullable(schema: Any) -> Any:
    """Return the schema that also allows null. A reference then points to a definition that allows it."""
    if not isinstance(schema, dict):
        return schema
    found = dict(schema)
    if "type" in found:
        types = found["type"] if isinstance(found["type"], list) else [found["type"]]
        found["type"] = types if "null" in types else [*types, "null"]
    if "enum" in found:
        found["enum"] = [*found["enum"], None]
    if "const" in found:
        found["enum"] = [found.pop("const"), None]
    branches: dict[str, Callable[[Any], Any]] = {
        "anyOf": _one_nullable,
        "oneOf": _one_nullable,
        "allOf": lambda each: [_nullable(one) for one in each],
        "then": _nullable,
        "else": _nullable,
    }
    for key, allow in branches.items():
        if key in found:
            found[key] = allow(found[key])
    return found


def _one_nullable(schemas: list[Any]) -> list[Any]:
    """Return the alternatives with null allowed in one of them, which is enough. Definitions of pieces allow it."""
    if any(str(each.get("$ref", "")).startswith(_DEFS + _PIECE) for each in schemas):
        return schemas
    for index, each in enumerate(schemas):
        if isinstance(each, dict) and "type" in each:
            return [*schemas[:index], _nullable(each), *schemas[index + 1 :]]
    return [*schemas, {"type": "null"}]


# The keys that a file that extends another one writes for itself.
_OWN = ("recipe", "extends", "trust")
_WITH_WHEN = ("class", "element.contact.pair", "element.contact.exclude")
# The items of MJCF's sections that can have `when`; the models of the others declare it.


def add_variation(schema: Schema, definitions: dict[str, Schema]) -> None:
    properties = schema["properties"]
    for name, definition in definitions.items():
        if name in _WITH_WHEN or name.startswith(("variant.", "named.")):
            _into(definition, "for", FOR)
            _into(definition, "when", WHEN)
    for name in sections_of(Singleton):
        _into(properties[name], "when", WHEN)
    definitions["InPlace"] = {
        "type": "object",
        "properties": {name: each for name, each in properties.items() if name not in OF_A_FILE},
        "additionalProperties": False,
        "description": "A recipe, instead of a model reference.",
    }
    _share(schema, definitions)
    pieces = loosened({name: each for name, each in properties.items() if name not in _OWN}, definitions)
    definitions["Piece"] = {
        "type": "object",
        "properties": {name: each for name, each in pieces.items() if name not in NO_PIECE},
        "additionalProperties": False,
        "description": "A piece of recipe: any of its keys. `null` removes the recipe's own value.",
    }
    _demand_less_of_what_extends(schema, pieces)


_SHORT = 80
# These have a condition, which editors show where it is written.
_UNSHARED = ("if", "then", "else", "allOf", "not", "propertyNames")


def _share(schema: Schema, definitions: dict[str, Schema]) -> None:
    """Move each schema that is written more than once, and is not `_SHORT`, to the definitions."""
    counts: Counter[str] = Counter()

    def count(each: Any, name: str) -> Any:
        text = json.dumps(each)
        counts[text] += 1
        if counts[text] == 1:  # its content is written once then
            _replaced(each, name, count)
        return each

    names: dict[str, str] = {}

    def move(each: Any, name: str) -> Any:
        text = json.dumps(each)
        if counts[text] == 1 or len(text) < _SHORT:
            return _replaced(each, name, move)
        if text not in names:
            keys = (f"shared.{name}{f'.{number}' if number > 1 else ''}" for number in itertools.count(1))
            names[text] = next(key for key in keys if key not in definitions)
            definitions[names[text]] = {}  # its name is taken
            definitions[names[text]] = _replaced(each, name, move)
        return {"$ref": _DEFS + names[text]}

    for replace_with in (count, move):
        for name in [None, *definitions]:
            if name is None:
                schema.update(_replaced(schema, "recipe", replace_with))
            else:
                definitions[name] = _replaced(definitions[name], name.rpartition(".")[2], replace_with)


def _replaced(schema: Any, name: str, replace: Callable[[Any, str], Any]) -> Any:
    """Return the schema with the schemas directly in it replaced; `name` is the key that has it."""
    if not isinstance(schema, dict):
        return schema
    found = dict(schema)
    for key, value in schema.items():
        if key in _MAPPINGS:
            found[key] = {each: replace(inner, each) for each, inner in value.items()}
        elif key in ("anyOf", "oneOf", "prefixItems"):
            found[key] = [replace(inner, name) for inner in value]
        elif key in ("additionalProperties", "items"):
            found[key] = replace(value, name)
        elif key in _UNSHARED:
            inner = value if isinstance(value, list) else [value]
            inner = [_replaced(each, name, replace) for each in inner]
            found[key] = inner if isinstance(value, list) else inner[0]
    return found


def _demand_less_of_what_extends(schema: Schema, pieces: Schema) -> None:
    """Require less from a file that extends another file: it is a piece, with the keys that only a whole recipe has."""
    whole = {name: schema.pop(name) for name in ("properties", "additionalProperties")}
    schema["if"] = {"required": ["extends"]}
    schema["then"] = {**whole, "properties": {**pieces, **{name: whole["properties"][name] for name in _OWN}}}
    schema["else"] = whole


def _into(schema: Any, key: str, value: Schema) -> None:
    if isinstance(schema.get("properties"), dict) and "additionalProperties" in schema:
        schema["properties"][key] = dict(value)
    for combined in ("anyOf", "oneOf", "allOf"):
        for each in schema.get(combined, ()):
            _into(each, key, value)
    for branch in ("then", "else"):
        if branch in schema:
            _into(schema[branch], key, value)


DIALECT = "https://json-schema.org/draft/2020-12/schema"
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
    schema = Recipe.model_json_schema(schema_generator=Generator)
    definitions: dict[str, Schema] = schema.pop("$defs")
    needed = definitions[Attachment.__name__].pop("required")
    definitions[Attachment.__name__]["allOf"].append({"required": needed})  # as in `element_schema`
    _complete(schema, definitions)
    add_variation(schema, definitions)
    # No title: editors would show it before every description.
    head = {"$schema": DIALECT, "description": "A recipe of mjcompose: the parts of a MuJoCo model."}
    whole = {**schema, **head, "$defs": definitions}
    for each in _mappings(whole):
        description = each.get("description")
        if isinstance(description, str) and "`" in description:
            each["markdownDescription"] = description  # else editors show the marks
    _share(whole, definitions)
    return {**whole, "$defs": dict(sorted(definitions.items()))}


def text() -> str:
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
