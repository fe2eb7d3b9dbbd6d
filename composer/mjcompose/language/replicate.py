"""The key `replicate` of a part: rows of copies, or copies that are scattered over a surface."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.limits import advice, in_force
from mjcompose.language.forms.context import Schema, Settings
from mjcompose.language.forms.model import IT, Bars, Model, Needs, OneOf
from mjcompose.language.forms.scalars import (
    LENGTHS,
    AtLeastOne,
    Attribute,
    Checked,
    Count,
    Expects,
    Items,
    Name,
    Scaled,
)
from mjcompose.language.value import EXCLUSIVE, Single

Vector = tuple[Single, ...]
SURFACES = ("geom", "site")
_ROW = ("count", "offset", "euler")


class Surface(Model):
    """A geom or a site with a size."""

    rules: ClassVar = (OneOf(*SURFACES, lacks="names no surface", advice="write `over: {geom: NAME}`"),)
    example: ClassVar = "{geom: …}"
    short: ClassVar = "geom"

    geom: Annotated[str, Name("geom")] | None = None
    """the copies lie on this geom"""
    site: Annotated[str, Name("site")] | None = None
    """the copies lie on the surface of this site, such as a flat box that marks a region of a table"""

    @property
    def named(self) -> tuple[str, str]:
        """Its kind and name."""
        return ("geom", self.geom) if self.geom is not None else ("site", self.site or "")


class Scatter(Model):
    """Copies at random places on a surface, without overlap."""

    example: ClassVar = "{count: 12, over: {geom: table/top}}"

    count: AtLeastOne = Field(examples=["12"])
    """how many"""
    over: Surface = Field(examples=["{geom: NAME}"])
    """the surface; each copy lies on it completely"""
    clearance: Annotated[float, Scaled(LENGTHS, ge=0)] = 0.0
    """the least distance of a copy from the others and from other bodies, in meters; `1cm` is 0.01"""
    upright: bool = True
    """copies are turned only about the vertical; false turns them in any direction"""
    seed: Count = 0
    """the seed of the places; draw a parameter for it to get other places in each sample"""
    key: Annotated[str, Name("key", what="the name of a keyframe")] | None = None
    """the keyframe in which nothing overlaps; without it, the reference configuration"""
    settle: Annotated[float, Scaled({"ms": 1e-3, "s": 1.0}, gt=0)] | None = None
    """lets the copies fall and come to rest for this time, in seconds; the rest of the model does not move"""


class Axis(Model):
    """A row of copies, each moved and turned from the one before; or copies on a surface."""

    rules: ClassVar = (Needs({"count": "3"}, unless="scatter"), Bars("scatter", *_ROW, why="scatters its copies"))
    example: ClassVar = "{count: 3, offset: [0.1, 0, 0]}"

    count: AtLeastOne = Field(1, examples=["3"])
    """how many"""
    offset: Annotated[Vector, Attribute("replicate", "offset")] = (0, 0, 0)
    """from each to the next, in the frame of the first"""
    euler: Annotated[Vector, Attribute("replicate", "euler")] = (0, 0, 0)
    """the rotation from one copy to the next"""
    scatter: Scatter | None = None
    """copies at random places on a surface, instead of a row"""

    @classmethod
    def subject(cls, at: Path) -> str:
        return "an axis of `replicate`"

    @property
    def copies(self) -> int:
        """The number of copies."""
        return self.count if self.scatter is None else self.scatter.count


def _too_many(axes: tuple[Axis, ...]) -> Fault | None:
    total, most = math.prod(axis.copies for axis in axes), in_force().copies
    if total <= most:
        return None
    message = f"{IT} makes {total} copies, and at most {most} are allowed"
    return Fault("limit-exceeded", message, help=advice("copies", total))


Axes = Annotated[
    tuple[Axis, ...], Items(1), Checked(_too_many), Expects("a list of axes", "[{count: 3, offset: [0.1, 0, 0]}]")
]


class ScatterAlone:
    """The rule that `scatter` is the only axis of a part, and places it alone."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        """Yield the fault of another axis, or of an offset that `scatter` replaces."""
        axes = value.get("replicate")
        axes = axes if isinstance(axes, list) else []
        scattering = any(isinstance(axis, dict) and "scatter" in axis for axis in axes)
        if scattering and len(axes) > 1:
            message, help = "`scatter` cannot have other axes next to it", "write the number of all copies in `scatter`"
            yield Fault(EXCLUSIVE, message, ("replicate",), key=True, help=help)
        if scattering and "pos" in value:
            help = "remove `pos`: `scatter` finds the position of each copy"
            yield Fault(EXCLUSIVE, f"{IT} has both `pos` and `scatter`", ("pos",), key=True, help=help)

    def schema(self) -> Iterator[Schema]:
        """Yield the conditions for editors."""
        for refused, more in (("replicate", {"minItems": 2}), ("pos", {})):
            axes = {"contains": {"required": ["scatter"]}, **more}
            then = {"properties": {refused: False}, "errorMessage": "`scatter` alone places the copies"}
            yield {"if": {"properties": {"replicate": axes}, "required": ["replicate"]}, "then": then}
