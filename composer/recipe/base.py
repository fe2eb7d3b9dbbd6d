"""The section `base`: the model that a recipe starts from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import GetJsonSchemaHandler, ModelWrapValidatorHandler, model_validator
from pydantic_core import CoreSchema

from composer.recipe.allow import Allowed
from composer.recipe.drop import Drop, Drops
from composer.recipe.edit import Edit, Edits
from composer.recipe.fault import validation_error
from composer.recipe.in_place import fault_of_inline_recipe
from composer.recipe.text import Choice
from composer.recipe.used_model import UsedModel

KeyPolicy = Literal["merge", "prefix", "none"]


class Base(UsedModel):
    """The model to start from, which keeps its own names; a reference alone is its `model`."""

    drop: Annotated[tuple[Drop, ...], Drops()] = ()
    """What to leave out, with all that refers to it: sections, tags and selectors."""
    edit: Annotated[tuple[Edit, ...], Edits()] = ()
    """Ordered changes to the model, before anything is attached to it."""
    keyframes: Annotated[KeyPolicy, Choice("keyframes")] = "merge"
    """What becomes of its keyframes: merged by name with those of the parts, kept apart, or left out."""
    allow: Annotated[tuple[str, ...], Allowed()] = ()
    """The codes of warnings about it that are meant to be there."""

    @model_validator(mode="wrap")
    @classmethod
    def _short(cls, value: Any, handler: ModelWrapValidatorHandler[Base]) -> Base:
        in_place = (
            fault_of_inline_recipe(value, "`base`", cls.model_fields) if isinstance(value, Mapping) else None
        )
        if in_place is not None:
            raise validation_error([in_place], value)
        return handler({"model": value} if isinstance(value, str) else value)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "minLength": 1}, handler.resolve_ref_schema(handler(schema))]}
