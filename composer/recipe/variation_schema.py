"""JSON Schema of what is settled before a recipe is validated: parameters, variants, conditions and their like."""

from __future__ import annotations

from typing import Any

from composer.expand.expand import SETTLED
from composer.expand.parameter import TYPES
from composer.expand.variants import NO_PIECE
from composer.formatting.order import WHOLE
from composer.recipe.piece_schema import loosened
from composer.recipe.reference import Schema
from composer.recipe.rows import check_rows

_VALUE: Schema = {"type": ["number", "boolean", "string", "array"]}
_BARE: Schema = {**_VALUE, "description": "the default alone; its type is that of the parameter"}
_PARAMETER: Schema = {
    "type": "object",
    "properties": {
        "type": {
            "enum": list(TYPES),
            "description": "what kind of value it has; without it, that of the default",
        },
        "default": {**_VALUE, "description": "its value where none is given; without it, one must be given"},
        "min": {"type": "number", "description": "the least that it, or a component of it, may be"},
        "max": {"type": "number", "description": "the most that it, or a component of it, may be"},
        "choices": {"type": "array", "minItems": 1, "description": "the values that it may have"},
        "length": {"type": "integer", "minimum": 1, "description": "how many numbers a vector has"},
        "unit": {"type": "string", "description": "for readers; `deg` and `rad` make it an angle"},
        "doc": {"type": "string", "description": "what it is for"},
    },
    "additionalProperties": False,
}
check_rows(
    "the keys of a parameter in composer/formatting/order.py", WHOLE["params", "*"], _PARAMETER["properties"]
)
# What a file that extends another says for itself.
_OWN = ("recipe", "extends")
_CELL: Schema = {"type": "object", "additionalProperties": _VALUE}
_HEAD: dict[str, Schema] = {
    "extends": {"type": "string", "minLength": 1, "description": "Another recipe, over which this file is merged."},
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
    "matrix": {
        "type": "object",
        "properties": {
            "axes": {"type": "object", "additionalProperties": {"type": "array", "minItems": 1},
                     "description": "The values of each variant or parameter, all combinations of which are built."},
            "exclude": {"type": "array", "items": _CELL, "description": "Combinations that are not built."},
            "include": {"type": "array", "items": _CELL, "description": "More combinations."},
            "name": {"type": "string", "description": "What a combination is called, with `${…}` for its values."},
        },
        "required": ["axes"],
        "additionalProperties": False,
        "description": "The combinations that `build --all` builds.",
    },
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
_SINGLETONS = ("option", "size", "visual", "statistic", "compiler")


def add_variation(schema: Schema, definitions: dict[str, Schema]) -> None:
    """Write these keys into the schema of a recipe, and the definition of a piece of recipe."""
    properties = schema["properties"]
    properties.update({name: dict(_HEAD[name]) for name in SETTLED})
    for name, definition in definitions.items():
        if name in _WITH_WHEN or name.startswith(("variant.", "named.")):
            _into(definition, "when", _WHEN)
    _into(definitions["addition"], "id", _ID)
    definitions["addition"]["maxProperties"] += 2
    for name in _SINGLETONS:
        _into(properties[name], "when", _WHEN)
    _into(properties["check"]["additionalProperties"], "when", _WHEN)
    pieces = loosened(properties, definitions)
    definitions["Piece"] = {
        "type": "object",
        "properties": {name: each for name, each in pieces.items() if name not in NO_PIECE},
        "additionalProperties": False,
        "description": "A piece of recipe: any of its keys. `null` takes out what the recipe has there.",
    }
    _demand_less_of_what_extends(schema, pieces)


def _demand_less_of_what_extends(schema: Schema, pieces: Schema) -> None:
    """A file that extends another is a piece of recipe too, with the keys that a whole one alone has."""
    whole = {name: schema.pop(name) for name in ("properties", "additionalProperties")}
    schema["if"] = {"required": ["extends"]}
    schema["then"] = {**whole, "properties": {**pieces, **{name: whole["properties"][name] for name in _OWN}}}
    schema["else"] = whole


def _into(schema: Any, key: str, value: Schema) -> None:
    """Put a property into every mapping with fixed keys that the schema describes at its top."""
    if isinstance(schema.get("properties"), dict) and "additionalProperties" in schema:
        schema["properties"][key] = dict(value)
    for combined in ("anyOf", "oneOf", "allOf"):
        for each in schema.get(combined, ()):
            _into(each, key, value)
    for branch in ("then", "else"):
        if branch in schema:
            _into(schema[branch], key, value)
