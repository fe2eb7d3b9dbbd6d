"""The recipe language: its models, their validation, and the JSON Schema."""

from __future__ import annotations

from composer.expr.angle import Angle
from composer.recipe.add import Addition
from composer.recipe.attach import Attachment
from composer.recipe.base import Base
from composer.recipe.default_class import DefaultClass
from composer.recipe.element import Element, Value
from composer.recipe.recipe import Recipe
from composer.recipe.validate import validate

__all__ = [
    "Addition",
    "Angle",
    "Attachment",
    "Base",
    "DefaultClass",
    "Element",
    "Recipe",
    "Value",
    "validate",
]
