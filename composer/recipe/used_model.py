"""A model that a recipe uses as its base or as a part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from composer.recipe.given import Given
from composer.recipe.in_place import ModelField
from composer.recipe.model import Model
from composer.recipe.text import Text
from composer.recipe.urdf_keys import UrdfKeys


class UsedModel(Model):
    """Which model is used, and how much of it: the keys that a base and a part have in common."""

    model: Annotated[str | Mapping[str, Any], ModelField()]
    """A model reference (a file relative to the recipe, `package:…`, `menagerie:…`), or a recipe written in place."""
    packages: dict[str, Annotated[str, Text("packages")]] = Field(default_factory=dict)
    """The folders that `package://NAME` stands for in URDF: a mapping from NAME to a path relative to the recipe; `"*"`
    is a ROS workspace, all of whose packages are meant."""
    urdf: UrdfKeys = Field(default_factory=UrdfKeys)
    """How a URDF is read: visuals, fixed links, actuators."""
    given: Annotated[dict[str, Any], Given()] = Field(default_factory=dict, alias="with")
    """Values of the parameters and variants of a nested recipe, or of the arguments of a xacro template, by name."""
    subtree: Annotated[str | None, Text("subtree")] = None
    """The one body of the model to take, with exactly what it needs; without it, the whole model."""
