"""The check `size`: how many of something the compiled model has."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind
from mjcompose.language.form import Schema, kind_of, reference

COUNTS: Mapping[str, str] = {
    "nq": "entries of `qpos`",
    "nv": "degrees of freedom",
    "nu": "controls",
    "na": "activation states",
    "nbody": "bodies, the world included",
    "njnt": "joints",
    "ngeom": "geoms",
    "nsite": "sites",
    "ncam": "cameras",
    "nlight": "lights",
    "nflex": "flexes",
    "nskin": "skins",
    "nmesh": "meshes",
    "nhfield": "height fields",
    "ntex": "textures",
    "nmat": "materials",
    "npair": "contact pairs",
    "nexclude": "contact excludes",
    "neq": "equality constraints",
    "ntendon": "tendons",
    "nactuator": "actuators",
    "nsensor": "sensors",
    "nsensordata": "entries of `sensordata`",
    "nnumeric": "custom numbers",
    "ntext": "custom texts",
    "ntuple": "custom tuples",
    "nplugin": "plugin instances",
    "nmocap": "mocap bodies",
    "nkey": "keyframes",
}
"""The sizes of mjModel that can be asked for, and what they count."""


@dataclass(frozen=True, slots=True)
class Size:
    """The numbers by the names of the sizes in mjModel. The place of one is `(*at, "size", NAME)`."""

    word: ClassVar[str] = "size"
    name: str
    counts: Mapping[str, int]
    at: Path


class Count:
    """Form of a whole number from 0."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> int | None:
        if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
            return value
        keys.add("wrong-type", f"`{at[-1]}` of {keys.owner} expects a count, got {kind_of(value)}", *at)
        return None

    def schema(self) -> Schema:
        return {**reference("integer"), "minimum": 0}


FORM = Keyed(
    "How many there are of something: sizes of mjModel.",
    *(Key(name, Count(), what) for name, what in COUNTS.items()),
    noun="size",
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Size:
    if not keys.value:
        keys.add("missing-key", f"`size` of {keys.owner} asks for nothing", help="write `size: {nu: 7}`")
    return Size(keys.name, {name: found[name] for name in keys.value if name in found}, at)


KIND = Kind("size", FORM, make, example="{nu: 7}")
