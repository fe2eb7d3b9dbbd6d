"""Pointers between the parts of the JSON Schema, before they have a place in it."""

from __future__ import annotations

from typing import Any

Schema = dict[str, Any]

REFERENCE = "mjcf"


def reference(name: str) -> Schema:
    """A pointer to a definition. Not `$ref`, of which pydantic wants to know the target."""
    return {REFERENCE: name}


def definition_key(name: str) -> str:
    """The key of a definition among `$defs`.

    >>> definition_key("variant:sensor/force")
    'variant.sensor.force'
    """
    return name.replace(":", ".").replace("/", ".")
