"""The form of the check `clearance`: geoms are not inside each other, or keep a distance."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from mjcompose.language.check import Check
from mjcompose.language.forms.scalars import LENGTHS, Expects, Items, Name, Scaled

_GLOB = Annotated[str, Name("geom", "body", glob=True)]
_SIDE = Annotated[tuple[_GLOB, ...], Items(1, single=True)]
_SIDES = Expects("two sides, each a glob over geoms or bodies or a list of them", '["arm/**", table]')
_PAIR = Annotated[tuple[_GLOB, ...], Items(2, 2), Expects("pairs of globs, each a list of its own", "[[a, b]]")]
_PAIRS = Expects("a list of pairs of globs", '[["gripper/**", "gripper/**"]]')


class Clearance(Check):
    """Geoms are not inside each other, or keep a distance."""

    word: ClassVar = "clearance"
    example: ClassVar = "{key: home}"
    instead: ClassVar = {
        "max": "write `min: -1mm` for a depth of at most 1 mm",
        "distance": "min",
        "exclude": "except",
        "keys": "key",
    }

    key: Annotated[tuple[Annotated[str, Name("key", glob=True)], ...], Items(1, single=True)] = ()
    """the keyframes to check; by default the reference configuration"""
    min: Annotated[float, Scaled(LENGTHS)] = -1e-3
    """the smallest allowed distance, in meters; a negative number allows an overlap of that depth"""
    excepted: Annotated[tuple[_PAIR, ...], Items(), _PAIRS] = Field((), alias="except")
    """pairs to ignore, as globs over names of geoms and bodies"""
    between: Annotated[tuple[_SIDE, ...], Items(2, 2), _SIDES] | None = None
    """the two sides, each a glob over geoms and bodies, or a list of globs; by default all geoms that can touch"""


KIND = Clearance
