"""The JSON Schema of what is applied before a recipe is validated: parameters, variants, conditions and the like."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.expand.expand import SETTLED
from composer.expand.matrix import EMITS
from composer.expand.matrix import KEYS as MATRIX_KEYS
from composer.expand.parameter import TYPES
from composer.expand.params import KEYS as PARAMETER_KEYS
from composer.expand.variants import NO_PIECE
from composer.recipe.in_place import OF_A_FILE
from composer.recipe.piece_schema import loosened
from composer.recipe.recipe import sections_of
from composer.recipe.reference import Schema
from composer.recipe.rows import check_rows
from composer.recipe.singleton import Singleton

_VALUE: Schema = {"type": ["number", "boolean", "string", "array"]}
_BARE: Schema = {**_VALUE, "description": "the default alone; its type is that of the parameter"}
_CELL: Schema = {"type": "object", "additionalProperties": _VALUE}


def _described(keys: Mapping[str, str], schemas: Mapping[str, Schema]) -> dict[str, Schema]:
    """Return the schemas of keys with their descriptions."""
    check_rows("the JSON Schema of keys in composer/recipe/variation_schema.py", schemas, keys)
    return {name: {**schemas[name], "description": about} for name, about in keys.items()}


_PARAMETER: Schema = {
    "type": "object",
    "properties": _described(
        PARAMETER_KEYS,
        {
            "type": {"enum": list(TYPES)},
            "default": _VALUE,
            "min": {"type": "number"},
            "max": {"type": "number"},
            "choices": {"type": "array", "minItems": 1},
            "length": {"type": "integer", "minimum": 1},
            "unit": {"type": "string"},
            "doc": {"type": "string"},
        },
    ),
    "additionalProperties": False,
}
_MATRIX: Schema = {
    "type": "object",
    "properties": _described(
        MATRIX_KEYS,
        {
            "axes": {"type": "object", "additionalProperties": {"type": "array", "minItems": 1}},
            "exclude": {"type": "array", "items": _CELL},
            "include": {"type": "array", "items": _CELL},
            "name": {"type": "string"},
            "emit": {"enum": list(EMITS)},
        },
    ),
    "required": ["axes"],
    "additionalProperties": False,
    "description": "The combinations that `build --all` builds.",
}
# What a file that extends another one writes for itself.
_OWN = ("recipe", "extends", "trust")
_HEAD: dict[str, Schema] = {
    "extends": {"type": "string", "minLength": 1, "description": "Another recipe, over which this file is merged."},
    "trust": {
        "type": "object",
        "properties": {
            "files": {"type": "array", "items": {"type": "string", "minLength": 1},
                      "description": "Folders outside the project that models may read, relative to the recipe."},
            "references": {"type": "array", "items": {"type": "string", "minLength": 1},
                           "description": "What fetched recipes may name of this machine and its network:"
                           " how such references begin, as `git+file:///srv/robots` or `package:NAME`."},
        },
        "additionalProperties": False,
        "description": "What is opened to others on this machine; it counts in the recipe that is built alone.",
    },
    "params": {
        "type": "object",
        "additionalProperties": {"anyOf": [_PARAMETER, _BARE]},
        "description": "Parameters by name: what `${name}` stands for, and what --set and `with` may set.",
    },
    "variants": {
        "type": "object",
        "additionalProperties": {
            "type": "object",
            "minProperties": 1,
            "additionalProperties": {"$ref": "#/$defs/Piece"},
        },
        "description": "Pieces of recipe by axis and value, of which one of each axis is merged over the recipe.",
    },
    "matrix": _MATRIX,
}  # fmt: skip
_WHEN: Schema = {
    "anyOf": [{"type": "object"}, {"type": "boolean"}, {"type": "string", "pattern": r"\$\{"}],
    "description": "The builds that this belongs to: values of variants and parameters, or one boolean `${…}`.",
}
_ID: Schema = {
    "type": "string",
    "minLength": 1,
    "description": "A name for merging: an item with the same one replaces this one.",
}
_WITH_WHEN = ("Attachment", "addition", "class", "element.contact.pair", "element.contact.exclude")


def add_variation(schema: Schema, definitions: dict[str, Schema]) -> None:
    """Add these keys to the schema of a recipe, and the definition of a piece of recipe."""
    properties = schema["properties"]
    properties.update({name: dict(_HEAD[name]) for name in SETTLED})
    for name, definition in definitions.items():
        if name in _WITH_WHEN or name.startswith(("variant.", "named.")):
            _into(definition, "when", _WHEN)
    _into(definitions["addition"], "id", _ID)
    definitions["addition"]["maxProperties"] += 2
    for name in sections_of(Singleton):
        _into(properties[name], "when", _WHEN)
    _into(properties["check"]["additionalProperties"], "when", _WHEN)
    definitions["InPlace"] = {
        "type": "object",
        "properties": {name: each for name, each in properties.items() if name not in OF_A_FILE},
        "additionalProperties": False,
        "description": "A recipe, written in place of a model reference.",
    }
    pieces = loosened(properties, definitions)
    definitions["Piece"] = {
        "type": "object",
        "properties": {name: each for name, each in pieces.items() if name not in NO_PIECE},
        "additionalProperties": False,
        "description": "A piece of recipe: any of its keys. `null` takes out what the recipe has there.",
    }
    _demand_less_of_what_extends(schema, pieces)


def _demand_less_of_what_extends(schema: Schema, pieces: Schema) -> None:
    """Require less of a file that extends another.

    It is a piece of recipe too, with the keys that only a whole one has.
    """
    whole = {name: schema.pop(name) for name in ("properties", "additionalProperties")}
    schema["if"] = {"required": ["extends"]}
    schema["then"] = {**whole, "properties": {**pieces, **{name: whole["properties"][name] for name in _OWN}}}
    schema["else"] = whole


def _into(schema: Any, key: str, value: Schema) -> None:
    """Add a property to every mapping with fixed keys at the top of a schema."""
    if isinstance(schema.get("properties"), dict) and "additionalProperties" in schema:
        schema["properties"][key] = dict(value)
    for combined in ("anyOf", "oneOf", "allOf"):
        for each in schema.get(combined, ()):
            _into(each, key, value)
    for branch in ("then", "else"):
        if branch in schema:
            _into(schema[branch], key, value)
