"""Compare two compiled models: every array and number of `mjModel`, bit for bit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from composer.compiled.kinds import Model
from composer.compiled.rows import Array, unequal

_PARTS = ("opt", "vis", "stat")
_OF_THE_PLACE = frozenset(
    {"paths", "npaths", "nbuffer", "mesh_pathadr", "hfield_pathadr", "skin_pathadr", "tex_pathadr"}
)
"""File paths at compilation, and the memory for them, which are not part of the model itself."""


def unequal_arrays(a: Model, b: Model) -> list[str]:
    """Return the attributes of `mjModel` that differ, including `opt.timestep` and the like; NaN equals NaN.

    Both models must come from the same MuJoCo: an attribute that only the first one has counts as different.
    """
    found = [
        name
        for name, value in _plain(a)
        if name not in _OF_THE_PLACE and _differ(value, getattr(b, name, None))
    ]
    for part in _PARTS:
        mine, theirs = getattr(a, part), getattr(b, part)
        for name, value in _plain(mine):
            other = getattr(theirs, name, None)
            if _is_plain(value):
                found += [f"{part}.{name}"] if _differ(value, other) else []
            else:  # a group of `vis`
                found += [f"{part}.{name}.{each}" for each, inner in _plain(value)
                          if _is_plain(inner) and _differ(inner, getattr(other, each, None))]  # fmt: skip
    return found


def _plain(holder: object) -> Iterator[tuple[str, object]]:
    for name in dir(holder):
        if not name.startswith("_"):
            value = getattr(holder, name)
            if not callable(value):
                yield name, value


def _is_plain(value: object) -> bool:
    return isinstance(value, (int, float, str, bytes)) or hasattr(value, "dtype")


def _differ(a: object, b: object) -> bool:
    if not _is_plain(a):
        return False
    if hasattr(a, "dtype") and hasattr(b, "dtype"):
        mine, theirs = cast("Array", a), cast("Array", b)
        return mine.shape != theirs.shape or bool(unequal(mine, theirs).any())
    return bool(a != b)
