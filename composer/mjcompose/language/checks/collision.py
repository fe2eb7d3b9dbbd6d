"""The check `collision`: shapes that are made of meshes are close enough to them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Globs, Key, Keyed, Keys, Kind, Number, Numbers

MEASURES = ("hausdorff", "beyond", "short", "uncovered", "volume")


@dataclass(frozen=True, slots=True)
class Collision:
    """What `collision` and `simplify` made of the `meshes` is within these limits. Without globs, all meshes count."""

    word: ClassVar[str] = "collision"
    name: str
    meshes: tuple[str, ...]
    hausdorff: float | None
    beyond: float | None
    short: float | None
    uncovered: float | None
    volume: tuple[float, float] | None
    at: Path


FORM = Keyed(
    "What `collision` and `simplify` made of meshes is near enough to them.",
    Key("meshes", Globs("globs over names of meshes"), "of which meshes; without it, of all", default=()),
    Key("hausdorff", Number(least=0), "the greatest distance of the two from one another, in metres"),
    Key("beyond", Number(least=0), "how far the shapes reach out of the mesh at most, in metres"),
    Key("short", Number(least=0), "how far the mesh reaches out of the shapes at most, in metres"),
    Key("uncovered", Number(least=0), "the greatest share of the surface outside of the shapes"),
    Key("volume", Numbers(2, "[0.9, 1.2]"), "the least and the most volume, by that of the mesh"),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Collision | None:
    if not any(name in keys.value for name in MEASURES):
        message = f"`collision` of {keys.owner} does not say how near"
        keys.add("missing-key", message, key=True, help="write for instance `hausdorff: 0.002`, in metres")
        return None
    volume = found["volume"]
    if volume is not None and volume[0] > volume[1]:
        low, high = volume
        message = f"`volume` of {keys.owner} starts with {low:g}, which is more than {high:g}"
        keys.add("out-of-range", message, "volume", help=f"write `volume: [{high:g}, {low:g}]`")
    return Collision(keys.name, at=at, **found)


KIND = Kind("collision", FORM, make, example="{hausdorff: 0.002}")
