"""The check `stable`: that a model comes to rest from a keyframe."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import NAME, Kind, mapping_schema
from composer.recipe.fault import Path
from composer.recipe.reference import reference

SECONDS, MAX_SPEED = 1.0, 0.05


@dataclass(frozen=True, slots=True)
class Stable:
    """From `key` (None: the reference configuration), no speed is above `max_speed` (m/s, rad/s) after `seconds`."""

    word: ClassVar[str] = "stable"
    name: str
    key: str | None
    seconds: float
    max_speed: float
    at: Path


def read(keys: Keys, at: Path) -> Stable | None:
    """The check, or None where there was a fault."""
    before = len(keys.faults)
    keys.known(("key", "seconds", "max_speed"))
    key = keys.text("key", "the name of a keyframe")
    seconds = keys.number("seconds", SECONDS, above=0)
    speed = keys.number("max_speed", MAX_SPEED, above=0)
    if len(keys.faults) > before or seconds is None or speed is None:
        return None
    return Stable(keys.name, key, seconds, speed, at)


KIND = Kind(
    "stable",
    read,
    mapping_schema(
        "The model comes to rest: simulated from a keyframe, it does not diverge and stands still at the end.",
        {
            "key": {**NAME, "description": "where it starts; without it, the reference configuration"},
            "seconds": {
                **reference("number"),
                "description": f"how long it is simulated (default: {SECONDS:g})",
            },
            "max_speed": {
                **reference("number"),
                "description": "the greatest speed of a joint in the last tenth of that time, in m/s or rad/s"
                f" (default: {MAX_SPEED:g})",
            },
        },
    ),
    "{key: home}",
)
