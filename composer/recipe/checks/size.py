"""The check `size`: how many there are of something in the compiled model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import Kind, mapping_schema
from composer.recipe.fault import Path
from composer.recipe.reference import reference
from composer.recipe.shown import kind_of

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
    """How many there are, by the name of the size in mjModel. Its place is `(*at, "size", NAME)`."""

    word: ClassVar[str] = "size"
    name: str
    counts: Mapping[str, int]
    at: Path


def read(keys: Keys, at: Path) -> Size | None:
    """The check, or None where there was a fault."""
    before = len(keys.faults)
    keys.known(COUNTS, "size")
    if not keys.value:
        keys.add("missing-key", f"`size` of {keys.owner} asks for nothing", help="write `size: {nu: 7}`")
    for size, value in keys.value.items():
        if size in COUNTS and (isinstance(value, bool) or not isinstance(value, int) or value < 0):
            message = f"`{size}` of {keys.owner} expects a count, got {kind_of(value)}"
            keys.add("wrong-type", message, size)
    return Size(keys.name, dict(keys.value), at) if len(keys.faults) == before else None


KIND = Kind(
    "size",
    read,
    mapping_schema(
        "How many there are of something: sizes of mjModel.",
        {name: {**reference("integer"), "description": what} for name, what in COUNTS.items()},
    ),
    "{nu: 7}",
)
