"""The form of the verb `inertia`: write down the inertia of a body that MuJoCo computes from its geoms."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from mjcompose.language.assign import Changed
from mjcompose.language.edit import For, Verb, listed
from mjcompose.language.forms.scalars import NumberUnit, Positive, Whole


class Inertia(Verb):
    """mass and inertia from the geoms, at a density"""

    rules: ClassVar = (For("body", what="for bodies, and `{tag}` is not a body", help="write `select: {body: NAME}`"),)
    example: ClassVar = "{from: mesh, density: 1000}"

    source: Literal["mesh", "geoms"] = Field(alias="from", examples=["mesh"])
    """from the geoms that are meshes, or from all geoms of the body"""
    density: Annotated[Positive, NumberUnit("kg/m³")] = Field(examples=[1000])
    """in kg/m³"""
    group: Whole | None = None
    """only from the geoms of this group"""

    def words(self) -> str:
        return f"inertia from {self.source}{listed({'density': self.density, 'group': self.group})}"

    def changes(self, tag: str | None) -> Changed:
        return [("inertial", name) for name in ("mass", "pos", "quat", "diaginertia")]


VERB = Inertia
