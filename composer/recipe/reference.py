"""Pointers between the parts of the JSON Schema, before they have a place in it, and what they lead to."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any

Schema = dict[str, Any]

REFERENCE = "mjcf"
_DEFINITIONS: dict[str, Callable[[str], Schema]] = {}


def definition(kind: str) -> Callable[[Callable[[str], Schema]], Callable[[str], Schema]]:
    """Marks the function that makes the definition `KIND:NAME`, or `KIND-NAME`, of a name.

    It is given the empty text where the pointer is `KIND` alone.
    """

    def register(make: Callable[[str], Schema]) -> Callable[[str], Schema]:
        if kind in _DEFINITIONS:
            raise TypeError(f"two functions make the definition {kind}")
        _DEFINITIONS[kind] = make
        return make

    return register


def define(name: str) -> Schema:
    """The schema that a reference leads to, the caller's own. Raises KeyError for one that nothing makes."""
    kind, _, rest = name.partition(":" if ":" in name else "-")
    return deepcopy(_DEFINITIONS[kind](rest))


def reference(name: str) -> Schema:
    """A pointer to a definition. Not `$ref`, of which pydantic wants to know the target."""
    return {REFERENCE: name}


def or_template(schema: Schema) -> Schema:
    """The schema of a value that `${…}` may compute; its description stands above both."""
    inner = {key: each for key, each in schema.items() if key not in ("description", "default")}
    outer = {key: each for key, each in schema.items() if key not in inner}
    return {"anyOf": [inner, reference("template")], **outer}


def definition_key(name: str) -> str:
    """The key of a definition among `$defs`.

    >>> definition_key("variant:sensor/force")
    'variant.sensor.force'
    """
    return name.replace(":", ".").replace("/", ".")
