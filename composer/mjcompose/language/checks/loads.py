"""The check `loads`: other programs read the model correctly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import NOT_READ_IN, READ_IN, Key, Keyed, Keys, Kind, Words

IN = "in"


@dataclass(frozen=True, slots=True)
class Loads:
    """Each of `consumers` reads the numbers, poses and motion of the model from what is written for it."""

    word: ClassVar[str] = "loads"
    name: str
    consumers: tuple[str, ...]
    at: Path


FORM = Keyed(
    "Other programs read the model back with its numbers, poses and motion.",
    Key(IN, Words(READ_IN, "program", NOT_READ_IN), "the programs that read it", needed="[drake, mjx]"),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Loads:
    return Loads(keys.name, found[IN], at)


KIND = Kind("loads", FORM, make, example="{in: [drake, mjx]}", of_target=True)
