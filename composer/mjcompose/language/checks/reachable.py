"""The form of the check `reachable`: joint positions exist that bring a site to a point."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from mjcompose.language.check import Check
from mjcompose.language.forms.scalars import LENGTHS, Expects, Items, Name, Scaled


class Reachable(Check):
    """The joints can bring a site to a point within their limits. Collisions do not count."""

    word: ClassVar = "reachable"
    needs_world: ClassVar = True
    example: ClassVar = "{site: tcp, target: [0.5, 0, 0.8]}"

    site: Annotated[str, Name("site")] = Field(examples=["NAME"])
    """the site to bring to the point"""
    target: Annotated[tuple[float, ...], Items(3, 3), Expects("a list of 3 numbers", "[0.5, 0, 0.8]")]
    """the point, in meters, in the world of this recipe"""
    tolerance: Annotated[float, Scaled(LENGTHS, gt=0)] = 1e-3
    """the largest remaining distance, in meters"""
    key: Annotated[str, Name("key", what="the name of a keyframe")] | None = None
    """the keyframe from which the search starts; by default the reference configuration"""


KIND = Reachable
