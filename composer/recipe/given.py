"""`with`: what a recipe gives to the parameters and variants of one that is nested in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from composer.recipe.fault import Fault, refusal
from composer.recipe.shown import kind_of


@dataclass(frozen=True, slots=True)
class Given:
    """Marks the field `with`, a mapping from names to values, which the nested recipe judges."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        value = {"type": ["number", "boolean", "string", "array"]}
        return {"type": "object", "additionalProperties": value}

    def _validate(self, value: Any) -> dict[str, Any]:
        if not isinstance(value, dict):
            message = f"`with` expects a mapping from names to values, got {kind_of(value)}"
            raise refusal([Fault("wrong-type", message, help="write `with: {reach: 0.5}`")], value)
        return dict(value)
