"""The JSON Schema of pieces of recipe, which are merged over another: no key is required, and `null` removes one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from composer.recipe.reference import Schema

_DEFS = "#/$defs/"
_PIECE = "piece."
_MAPPINGS = ("properties", "patternProperties")
_LISTED = ("anyOf", "oneOf", "allOf", "prefixItems")
_NESTED = ("additionalProperties", "items", "then", "else", "not")


def loosened(properties: Schema, definitions: dict[str, Schema]) -> Schema:
    """Return the same properties, all optional and with null allowed. New definitions go to `definitions`.

    Conditions stay as they are: those that decide between forms require nothing.
    """
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
        if key in _MAPPINGS:
            found[key] = loosened(value, definitions)
        elif key in _LISTED:
            found[key] = _optional(value, definitions)
        elif key == "additionalProperties" and isinstance(value, dict):
            found[key] = _nullable(_optional(value, definitions))
        elif key in _NESTED:
            found[key] = _optional(value, definitions)
        elif key == "$ref":
            found[key] = _reference(value, definitions)
        else:
            found[key] = value
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
    """Return the schema that also allows null. A reference then points to a definition that does."""
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
    """Return the alternatives with null allowed in one of them, which is enough."""
    for index, each in enumerate(schemas):
        if isinstance(each, dict) and "type" in each:
            return [*schemas[:index], _nullable(each), *schemas[index + 1 :]]
    return [*schemas, {"type": "null"}]
