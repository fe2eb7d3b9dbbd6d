"""What a kind of check is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from composer.recipe.checks.keys import Keys
from composer.recipe.fault import Path
from composer.recipe.reference import Schema


class Check(Protocol):
    """One check of a recipe: its kind, its name, and its path from the top of the recipe."""

    @property
    def word(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def at(self) -> Path: ...


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of check. `read` gives None where it reported a fault; `example` is what messages advise to write.

    What stands behind the word is a mapping, or a list where `listed`. A check that `needs_world` is about
    points in the world of its recipe, and cannot be run where it is not known where that is.
    """

    word: str
    read: Callable[[Keys, Path], Check | None]
    schema: Schema
    example: str
    listed: bool = False
    needs_world: bool = False


def mapping_schema(description: str, properties: dict[str, Any], *required: str) -> Schema:
    """The JSON Schema of a mapping with these keys and no others."""
    schema: Schema = {"type": "object", "description": description, "properties": properties}
    if required:
        schema["required"] = list(required)
    return {**schema, "additionalProperties": False}


NAME: Schema = {"type": "string", "minLength": 1}
