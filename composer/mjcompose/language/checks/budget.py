"""The check `budget`: limits on what a model costs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Globs, Key, Keyed, Keys, Kind, Number

AT_MOST = {
    "faces": "the most triangles that the meshes have together",
    "bytes": "the most bytes that the files of the model have together: its text, meshes, textures, …",
    "textures": "the most bytes that the textures have together in memory, unpacked",
    "contacts": "the most contacts in a keyframe, or in the reference configuration",
}
SPEED = "steps_per_second"
KEYS = "keys"


@dataclass(frozen=True, slots=True)
class Budget:
    """The most that a model may have of each thing in `most`, and the least steps per second on this machine.

    `keys` are globs over the keyframes in which contacts are counted. Without globs, these are all keyframes and
    the reference configuration.
    """

    word: ClassVar[str] = "budget"
    name: str
    most: Mapping[str, float]
    speed: float | None
    keys: tuple[str, ...]
    at: Path


FORM = Keyed(
    "The model does not cost more than it may.",
    *(Key(name, Number(least=0), about) for name, about in AT_MOST.items()),
    Key(
        SPEED,
        Number(above=0),
        "the least steps in a second of one thread of this machine: a measurement, which depends on the machine",
    ),
    Key(
        KEYS,
        Globs("globs over names of keyframes"),
        "the keyframes in which contacts are counted; without it, all and the reference configuration",
        default=(),
    ),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Budget:
    most = {name: found[name] for name in AT_MOST if found[name] is not None}
    is_reported = any(each.at[:2] == (keys.name, keys.word) for each in keys.faults)
    if not is_reported and not any(name in keys.value for name in (*AT_MOST, SPEED)):
        keys.add(
            "missing-key",
            f"`budget` of {keys.owner} limits nothing",
            key=True,
            help="write `budget: {faces: 50000}`",
        )
    return Budget(keys.name, most, found[SPEED], keys=found[KEYS], at=at)


KIND = Kind("budget", FORM, make, example="{faces: 50000}")
