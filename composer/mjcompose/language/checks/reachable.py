"""The check `reachable`: a site can be moved to a point."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind, Name, Number, Numbers

TOLERANCE = 1e-3
_POINT = "[0.5, 0, 0.8]"


@dataclass(frozen=True, slots=True)
class Reachable:
    """Some joint positions within their limits bring `site` to `target` (metres, in the world of the recipe)."""

    word: ClassVar[str] = "reachable"
    name: str
    site: str
    target: tuple[float, ...]
    tolerance: float
    key: str | None
    at: Path


FORM = Keyed(
    "Joint positions within their limits bring a site to a point. Collisions are not looked at.",
    Key("site", Name("the name of a site"), "the site that is brought there", needed="NAME"),
    Key(
        "target",
        Numbers(3, _POINT),
        "the point, in metres, in the world of this recipe",
        needed=_POINT,
    ),
    Key("tolerance", Number(above=0), "how near it must come, in metres", default=TOLERANCE),
    Key(
        "key",
        Name("the name of a keyframe"),
        "where everything else is, and the search starts; without it, the reference configuration",
    ),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Reachable:
    return Reachable(keys.name, at=at, **found)


KIND = Kind("reachable", FORM, make, example="{site: tcp, target: [0.5, 0, 0.8]}", needs_world=True)
