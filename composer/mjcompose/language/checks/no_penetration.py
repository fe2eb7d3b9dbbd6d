"""The check `no_penetration`: contacts are not deep."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind, Name, Number
from mjcompose.language.form import Schema, kind_of
from mjcompose.language.select import GLOB

MAX = 1e-3


@dataclass(frozen=True, slots=True)
class NoPenetration:
    """At `key`, no contact is deeper than `max` metres. Without a key, at the reference configuration.

    `exclude` has pairs of globs over names of geoms and bodies whose contacts do not count.
    """

    word: ClassVar[str] = "no_penetration"
    name: str
    key: str | None
    max: float
    exclude: tuple[tuple[str, str], ...]
    at: Path


class Pairs:
    """Form of pairs of globs, read as a tuple of pairs."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[tuple[str, ...], ...]:
        if not isinstance(value, list):
            message = f"`{at[-1]}` of {keys.owner} expects a list of pairs of globs, got {kind_of(value)}"
            keys.add("wrong-type", message, *at, help=f'write for instance `{at[-1]}: [["arm/**", table]]`')
            return ()
        return tuple(self._pair(keys, each, *at, index) for index, each in enumerate(value))

    def _pair(self, keys: Keys, value: Any, *at: str | int) -> tuple[str, ...]:
        if isinstance(value, list) and len(value) == 2:
            what = "globs over names of geoms or bodies"
            return tuple(keys.glob_of(each, what, *at, side) or "" for side, each in enumerate(value))
        got = f"{len(value)} of them" if isinstance(value, list) else kind_of(value)
        message = f"`{at[0]}` of {keys.owner} expects pairs of globs, got {got}"
        code = "wrong-length" if isinstance(value, list) else "wrong-type"
        keys.add(code, message, *at, help=f"a pair is a list of its own: `{at[0]}: [[a, b]]`")
        return ()

    def schema(self) -> Schema:
        return {
            "type": "array",
            "items": {"type": "array", "items": dict(GLOB), "minItems": 2, "maxItems": 2},
        }


FORM = Keyed(
    "Nothing is inside of something else at a keyframe, as far as geoms can touch.",
    Key("key", Name("the name of a keyframe"), "the pose; without it, the reference configuration"),
    Key("max", Number(least=0), "the greatest depth, in metres", default=MAX),
    Key(
        "exclude",
        Pairs(),
        "pairs of globs over names of geoms and bodies whose contacts do not count",
        default=(),
    ),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> NoPenetration:
    return NoPenetration(keys.name, at=at, **found)


KIND = Kind("no_penetration", FORM, make, example="{key: home}")
