"""The check `reachable`: that a site can be brought to a point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import NAME, Kind, mapping_schema
from composer.recipe.fault import Path
from composer.recipe.reference import reference

TOLERANCE = 1e-3


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


def read(keys: Keys, at: Path) -> Reachable | None:
    """The check, or None where there was a fault."""
    before = len(keys.faults)
    keys.known(("site", "target", "tolerance", "key"))
    keys.required("site", "NAME")
    keys.required("target", "[0.5, 0, 0.8]")
    site, key = keys.text("site", "the name of a site"), keys.text("key", "the name of a keyframe")
    target = keys.numbers("target", 3, "[0.5, 0, 0.8]")
    tolerance = keys.number("tolerance", TOLERANCE, above=0)
    if len(keys.faults) > before or site is None or target is None or tolerance is None:
        return None
    return Reachable(keys.name, site, target, tolerance, key, at)


KIND = Kind(
    "reachable",
    read,
    mapping_schema(
        "Joint positions within their limits bring a site to a point. Collisions are not looked at.",
        {
            "site": {**NAME, "description": "the site that is brought there"},
            "target": {
                **reference("number-3"),
                "description": "the point, in metres, in the world of this recipe",
            },
            "tolerance": {
                **reference("number"),
                "description": f"how near it must come, in metres (default: {TOLERANCE:g})",
            },
            "key": {
                **NAME,
                "description": "where everything else is, and the search starts; without it, the"
                " reference configuration",
            },
        },
        "site",
        "target",
    ),
    "{site: tcp, target: [0.5, 0, 0.8]}",
    needs_world=True,
)
