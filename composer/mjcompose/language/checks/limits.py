"""The check `limits`: keys are within the ranges of joints and actuators."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Globs, Key, Keyed, Keys, Kind, Number

MARGIN = 0.0


@dataclass(frozen=True, slots=True)
class Limits:
    """In the keys that match a glob of `keys`, `qpos`, `ctrl` and `act` are inside their ranges.

    Without globs, all keys count. The values stay `margin` away from both ends, in the unit of each range.
    """

    word: ClassVar[str] = "limits"
    name: str
    keys: tuple[str, ...]
    exclude: tuple[str, ...]
    margin: float
    at: Path


FORM = Keyed(
    "In keyframes, positions, controls and activations are within their ranges.",
    Key(
        "keys", Globs("globs over names of keyframes"), "which keyframes; without it, all of them", default=()
    ),
    Key(
        "exclude",
        Globs("globs over names of joints and actuators"),
        "joints and actuators that do not count",
        default=(),
    ),
    Key(
        "margin",
        Number(least=0),
        "how far they stay from both ends, in the unit of each range",
        default=MARGIN,
    ),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Limits:
    return Limits(keys.name, at=at, **found)


KIND = Kind("limits", FORM, make, example="{}")
