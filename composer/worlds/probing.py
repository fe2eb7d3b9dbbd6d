"""Detect values that a simulator shares between worlds although they differ, which would be wrong without an error."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Collection, Iterable, Iterator
from typing import Any

import numpy as np

from composer.compiled.kinds import Model
from composer.compiled.varying import flat, put
from composer.worlds.errors import failure
from composer.worlds.simulator import Simulator
from composer.worlds.worlds import Worlds

_FLAG = "has"
NOT_STEPPED = (
    "key_",
    "light_",
    "mat_",
    "tex_",
    "cam_",
    "geom_rgba",
    "site_rgba",
    "tendon_rgba",
    "names",
    "stat.",
)
"""Arrays that a step does not read: if a simulator shares them, only its rendering and resets are affected."""


def is_stepped(name: str) -> bool:
    """Return whether a step reads the array."""
    return not name.startswith(NOT_STEPPED)


def check_nothing_is_shared(
    worlds: Worlds, simulator: Simulator, varied: Collection[str], instead: str
) -> None:
    """Compare a simulator's conversions of the nominal model and of one in which every varying number differs.

    Every difference must be among the `varied` arrays. MuJoCo Warp, for instance, leaves springs of tendons out of
    its steps if the converted model has none, whatever the arrays of the worlds say. Raises LoadError.
    """
    before, after = (
        dict(_leaves(simulator.take(worlds, each))) for each in (worlds.nominal, _otherwise(worlds))
    )
    last = {name.rpartition(".")[2] for name in varied}
    shared = [
        name for name, value in before.items()
        if name not in varied and name.rpartition(".")[2] not in last and is_stepped(name.removeprefix("_impl."))
        and name in after and not _same(value, after[name]) and not (_FLAG in name and _covers(value, after[name]))
    ]  # fmt: skip
    if shared:
        message = f"{simulator.name} has {_listed(shared)} once for all worlds, computed from what differs"
        raise failure(
            "not-per-world", message, instead, notes=[f"between these worlds differ {_listed(worlds.arrays)}"]
        )


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _otherwise(worlds: Worlds) -> Model:
    """Return a model in which each varying number is the largest of the values that are not nominal."""
    model = copy.copy(worlds.nominal)
    for name, varying in worlds.arrays.items():
        numbers = flat(model, name).copy()
        other = varying.values != numbers[varying.index]
        chosen = np.where(other, np.abs(varying.values), -1).argmax(axis=0)
        numbers[varying.index] = varying.values[chosen, np.arange(varying.index.size)]
        put(model, name, numbers)
    return model


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield all values in a structure by their path."""
    if dataclasses.is_dataclass(value):
        for each in dataclasses.fields(value):
            if hasattr(value, each.name):
                yield from _leaves(getattr(value, each.name), f"{name}.{each.name}" if name else each.name)
    else:
        yield name, value


def _covers(before: Any, after: Any) -> bool:
    """Return whether the flags include all that would be set; additional ones only cost time."""
    return not np.any(np.asarray(after, bool) & ~np.asarray(before, bool))


def _same(a: Any, b: Any) -> bool:
    if hasattr(a, "numpy"):
        a, b = a.numpy(), b.numpy()
    if hasattr(a, "shape"):
        a, b = np.asarray(a), np.asarray(b)
        return a.shape == b.shape and (
            a.dtype.kind not in "biufc" or np.array_equal(a, b, equal_nan=a.dtype.kind in "fc")
        )
    return not isinstance(a, bool | int | float | str) or a == b
