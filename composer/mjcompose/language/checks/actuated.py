"""The check `actuated`: every joint has an actuator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Globs, Key, Keyed, Keys, Kind

_JOINTS = Globs("globs over names of joints")


@dataclass(frozen=True, slots=True)
class Actuated:
    """An actuator moves every joint that a glob of `joints` names, directly or by a tendon.

    Without globs, every hinge and slide is meant.
    """

    word: ClassVar[str] = "actuated"
    name: str
    joints: tuple[str, ...]
    exclude: tuple[str, ...]
    at: Path


FORM = Keyed(
    "Every joint is moved by an actuator, also by way of a tendon or of an equality to another joint.",
    Key("joints", _JOINTS, "which joints; without it, all hinges and slides", default=()),
    Key("exclude", _JOINTS, "joints that need none", default=()),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Actuated:
    return Actuated(keys.name, at=at, **found)


KIND = Kind("actuated", FORM, make, example="{}")
