"""The check `plausible`: masses and inertias fit the shapes of the bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Globs, Key, Keyed, Keys, Kind, Number, Numbers

_BODIES = Globs("globs over names of bodies")
GYRATION, OUTSIDE = 1.0, 0.02


@dataclass(frozen=True, slots=True)
class Plausible:
    """The inertia of each body that matches a glob of `bodies` is possible for its geoms.

    Without globs, all bodies with mass and geoms count. `density` is the allowed range in kg/m³, None for any.
    `gyration` is the largest radius of gyration, and `outside` the largest distance of the centre of mass from the
    box around the geoms, both relative to the size of the geoms.
    """

    word: ClassVar[str] = "plausible"
    name: str
    bodies: tuple[str, ...]
    exclude: tuple[str, ...]
    density: tuple[float, float] | None
    gyration: float
    outside: float
    at: Path


FORM = Keyed(
    "Masses and inertias could be those of the bodies, as far as their geoms show.",
    Key("bodies", _BODIES, "which bodies; without it, all that have mass and geoms", default=()),
    Key("exclude", _BODIES, "bodies that are not looked at", default=()),
    Key(
        "density", Numbers(2, "[100, 9000]"), "the least and the most, in kg/m³; without it, any"
    ),
    Key(
        "gyration",
        Number(above=0),
        "the largest radius of gyration, relative to the distance of the farthest point from the centre of mass",
        default=GYRATION,
    ),
    Key(
        "outside",
        Number(least=0),
        "how far the centre of mass may be outside the box around the geoms, relative to the diagonal of the box",
        default=OUTSIDE,
    ),
)  # fmt: skip


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Plausible:
    density = found["density"]
    if density is not None and not 0 <= density[0] <= density[1]:
        message = f"`density` of {keys.owner} is a range that starts at 0 or more, and does not end before it starts"
        keys.add("out-of-range", message, "density", help="write for instance `density: [100, 9000]`")
    return Plausible(keys.name, at=at, **found)


KIND = Kind("plausible", FORM, make, example="{}")
