"""The check `clear`: sets of geoms keep a distance from each other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Globs, Key, Keyed, Keys, Kind, Number
from mjcompose.language.form import Schema

_SIDES = '["arm/**", table]'


@dataclass(frozen=True, slots=True)
class Clear:
    """The geoms of the two sides of `between` are at least `distance` metres apart in each of `keys`.

    Without keys, the reference configuration is checked. A side has globs over names of geoms and bodies; a body
    stands for its own geoms.
    """

    word: ClassVar[str] = "clear"
    name: str
    between: tuple[tuple[str, ...], ...]
    distance: float
    keys: tuple[str, ...]
    at: Path


class Sides:
    """Form of two sides. Each is a glob or a list of globs, read as a tuple."""

    side = Globs("a glob over names of geoms or bodies")

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[tuple[str, ...], ...]:
        if isinstance(value, list) and len(value) == 2:
            return tuple(self._side(keys, side, *at, index) for index, side in enumerate(value))
        message = f"`{at[-1]}` of {keys.owner} expects two sides, each a glob over geoms or bodies or a list of them"
        code = "wrong-length" if isinstance(value, list) else "wrong-type"
        keys.add(code, message, *at, help=f"write for instance `{at[-1]}: {_SIDES}`")
        return ()

    def _side(self, keys: Keys, value: Any, *at: str | int) -> tuple[str, ...]:
        if value == []:
            keys.add("wrong-type", f"a side of `{at[0]}` of {keys.owner} is an empty list", *at)
            return ()
        return self.side.read(keys, value, *at)

    def schema(self) -> Schema:
        return {"type": "array", "items": self.side.schema(), "minItems": 2, "maxItems": 2}


FORM = Keyed(
    "Geoms keep a distance from one another, whether they can touch or not.",
    Key(
        "between",
        Sides(),
        "the two sides, each a glob over names of geoms and bodies or a list of them",
        needed=_SIDES,
    ),
    Key("distance", Number(least=0), "the least distance, in metres", needed="0.02"),
    Key(
        "keys",
        Globs("globs over names of keyframes"),
        "in which keyframes; without it, in the reference configuration",
        default=(),
    ),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Clear:
    return Clear(keys.name, at=at, **found)


KIND = Kind("clear", FORM, make, example=f"{{between: {_SIDES}, distance: 0.02}}")
