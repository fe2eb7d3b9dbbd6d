"""The model that a recipe starts from."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, GetJsonSchemaHandler, ModelWrapValidatorHandler, model_validator
from pydantic_core import CoreSchema

from composer.recipe.drop import Drop, Drops
from composer.recipe.edit import Edit, Edits
from composer.recipe.given import Given
from composer.recipe.model import Model
from composer.recipe.text import Choice, Text

KeyPolicy = Literal["merge", "prefix", "none"]


class Base(Model):
    """The model to start from, which keeps its own names; a reference alone is its `model`."""

    model: Annotated[str, Text("model")]
    """A model reference: a file relative to the recipe, `package:…`, `menagerie:…`."""
    packages: dict[str, Annotated[str, Text("packages")]] = Field(default_factory=dict)
    """The folders that `package://NAME` stands for in URDF: a mapping from NAME to a path relative to the recipe."""
    given: Annotated[dict[str, Any], Given()] = Field(default_factory=dict, alias="with")
    """Values of the parameters and variants of a nested recipe, by name."""
    subtree: Annotated[str | None, Text("subtree")] = None
    """The one body of the model to take, with exactly what it needs; without it, the whole model."""
    drop: Annotated[tuple[Drop, ...], Drops()] = ()
    """What to leave out, with all that refers to it: sections, tags and selectors."""
    edit: Annotated[tuple[Edit, ...], Edits()] = ()
    """Ordered changes to the model, before anything is attached to it."""
    keyframes: Annotated[KeyPolicy, Choice("keyframes")] = "merge"
    """What becomes of its keyframes: merged by name with those of the parts, kept apart, or left out."""

    @model_validator(mode="wrap")
    @classmethod
    def _short(cls, value: Any, handler: ModelWrapValidatorHandler[Base]) -> Base:
        return handler({"model": value} if isinstance(value, str) else value)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "minLength": 1}, handler.resolve_ref_schema(handler(schema))]}
