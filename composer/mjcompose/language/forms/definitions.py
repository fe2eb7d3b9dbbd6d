"""Definitions of the JSON Schema by name: several places refer to one definition."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any

Schema = dict[str, Any]


REFERENCE = "mjcf"


_DEFINITIONS: dict[str, Callable[[str], Schema]] = {}


def definition(kind: str) -> Callable[[Callable[[str], Schema]], Callable[[str], Schema]]:
    """Return a decorator for the function that makes the definition `KIND:NAME`, or `KIND-NAME`, of a name.

    The function gets an empty name if the reference is only `KIND`.
    """

    def register(make: Callable[[str], Schema]) -> Callable[[str], Schema]:
        if kind in _DEFINITIONS:
            raise TypeError(f"two functions make the definition {kind}")
        _DEFINITIONS[kind] = make
        return make

    return register


@definition("made")
def _made(name: str) -> Schema:
    """Return a reference to a definition derived from the whole schema: `InPlace`, `Piece`."""
    return {"$ref": f"#/$defs/{name}"}


def define(name: str) -> Schema:
    """Return the schema that a reference leads to; the caller may change it. Raises KeyError for an unknown one."""
    kind, _, rest = name.partition(":" if ":" in name else "-")
    return deepcopy(_DEFINITIONS[kind](rest))


def reference(name: str) -> Schema:
    """Return a reference to a definition. It is not `$ref`, whose target pydantic would want to know."""
    return {REFERENCE: name}


def definition_key(name: str) -> str:
    """Return the key of a definition in `$defs`.

    >>> definition_key("variant:sensor/force")
    'variant.sensor.force'
    """
    return name.replace(":", ".").replace("/", ".")
