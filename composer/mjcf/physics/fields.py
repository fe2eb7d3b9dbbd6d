"""The arrays of `mjModel` and `mjData` that have rows for the elements of a kind, by all their names.

They come from the running MuJoCo, which describes its own structs and the size that determines each array's rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from composer.compiled.addresses import RUNS
from composer.compiled.kinds import KINDS
from composer.dataclass import dataclass

# short name keeps it, so that `solref` of a joint is `jnt_solref` and the other one is `dof_solref`.
_MORE_WORDS = {"joint": ("dof",), "tendon": ("ten",), "skin": ("skin",), "flex": ("flexedge", "flexvert")}
_ALIASES = {"sensor": {"data": "sensordata"}}
# Lists of indices, and rows that are dealt out anew in every step: no row of an element.
_NO_ROWS = frozenset({"body_awake_ind", "parent_awake_ind", "dof_awake_ind", "wrap_obj", "wrap_xpos"})
# From here on the arrays of mjData are made anew in every step.
_FIRST_OF_STEP = "contact"


@dataclass(frozen=True, slots=True)
class Field:
    """An array by MuJoCo's name, whether it belongs to `mjData`, and the size that determines its rows (`nv`)."""

    array: str
    of_data: bool
    size: str


@cache
def fields(kind: str) -> Mapping[str, Field]:
    """Return the fields of a kind by MuJoCo's full names and by the names without the kind (`geom_xpos` and `xpos`)."""
    own_size = next(field.size for field in _arrays() if field.array == KINDS[kind].addresses)
    sizes = {own_size, *RUNS.get(kind, ())}
    found = {field.array: field for field in _arrays() if field.size in sizes}
    short: dict[str, Field] = {}
    for word in (KINDS[kind].arrays, *_MORE_WORDS.get(kind, ())):
        for name, field in found.items():
            if name.startswith(f"{word}_"):
                short.setdefault(name.removeprefix(f"{word}_"), field)
    for name, array in _ALIASES.get(kind, {}).items():
        short[name] = found[array]
    return MappingProxyType({**short, **found})


@cache
def _arrays() -> tuple[Field, ...]:
    """Return every array of numbers in both structs whose memory does not move during the life of the struct."""
    return (*_of_struct("mjModel"), *_of_struct("mjData"))


def _of_struct(name: str) -> Iterator[Field]:
    from mujoco.introspect.structs import STRUCTS

    struct: Any = STRUCTS[name]
    for field in struct.fields:
        if field.name == _FIRST_OF_STEP:
            return
        extent = getattr(field, "array_extent", None)
        if extent and field.name not in _NO_ROWS and not _is_text(field.type):
            yield Field(field.name, name == "mjData", str(extent[0]))


def _is_text(pointer: Any) -> bool:
    """Return whether a pointer is to text, which Python returns as bytes and not as a view."""
    return getattr(getattr(pointer, "inner_type", None), "name", None) == "char"
