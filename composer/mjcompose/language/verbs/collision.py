"""The form of the verb `collision`: replace meshes in collisions by convex shapes made from them."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from mjcompose.language.edit import For, Verb, with_settings
from mjcompose.language.forms.model import Model, OneOf
from mjcompose.language.forms.scalars import whole

_METHODS = ("hull", "fit", "decompose", "spheres")
_Vertices = Annotated[int, Field(ge=4, le=10_000), BeforeValidator(whole)]
_Count = Annotated[int, Field(ge=1, le=1000), BeforeValidator(whole)]
_Seed = Annotated[int, Field(ge=0, le=10**9), BeforeValidator(whole)]


class Hull(Model):
    """the convex hull"""

    example: ClassVar = "{}"

    vertices: _Vertices | None = None
    """the largest number of vertices (default: no limit)"""


class Decompose(Model):
    """convex pieces, by CoACD"""

    example: ClassVar = "{}"

    parts: _Count | None = None
    """the largest number of pieces (default: no limit)"""
    threshold: Annotated[float, Field(ge=0.01, le=1)] = 0.05
    """the allowed concavity of a piece, by CoACD's measure"""
    vertices: _Vertices = 256
    """the largest number of vertices of a piece"""
    seed: _Seed = 0
    """the seed of random choices"""


class Spheres(Model):
    """balls that cover the surface"""

    example: ClassVar = "{count: 16}"

    count: _Count = Field(examples=[16])
    """how many"""
    seed: _Seed = 0
    """the seed of random choices"""


class Collision(Verb):
    """convex shapes for its contacts, made of its mesh"""

    rules: ClassVar = (
        For("geom", what="for geoms, and `{tag}` is not a geom", help="select the geoms of the meshes"),
        OneOf(*_METHODS, lacks="says no way to make shapes", advice="write `hull: {}`"),
    )
    example: ClassVar = "{hull: {}}"
    noun: ClassVar = "method"
    reshapes: ClassVar = True

    hull: Hull | None = None
    """the convex hull"""
    fit: Literal["box", "sphere", "capsule", "cylinder", "best"] | None = None
    """one primitive around the mesh; `best` has the smallest volume"""
    decompose: Decompose | None = None
    """convex pieces, by CoACD"""
    spheres: Spheres | None = None
    """balls that cover the surface"""

    @property
    def method(self) -> str:
        return next(iter(self.model_fields_set))

    @property
    def wanted(self) -> str | dict[str, Any]:
        """The primitive of `fit`, or the settings of another method, with their defaults."""
        settings = getattr(self, self.method)
        return settings if isinstance(settings, str) else dict(settings)

    def words(self) -> str:
        return f"collide with {with_settings(self.method, self.wanted)}"


VERB = Collision
