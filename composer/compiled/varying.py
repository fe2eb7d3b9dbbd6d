"""Collect the numbers that differ between models that are otherwise equal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from composer.compiled.kinds import Model

Numbers = NDArray[Any]
MEAN_INERTIA = "stat.meaninertia"
_LARGE = 1 << 16
"""Larger arrays are assets, such as the vertices of meshes. For draws from one model they are only compared in the
first worlds.
"""
_FIRST = 4


class Differences:
    """The differences from the nominal model in this many worlds: by array, the numbers that differ in any of them."""

    def __init__(self, model: Model, worlds: int) -> None:
        self.model, self.worlds = model, worlds
        self.nominal = {name: flat(model, name).copy() for name in arrays(model)}
        self.index: dict[str, Numbers] = {}
        self.values: dict[str, Numbers] = {}
        self.changed: set[str] = set()

    def take(self, world: int, model: Model | None = None, count: int = 1) -> None:
        """Record the model's state for this world, or for `count` worlds from it.

        `model`, if given, is recorded instead; its arrays must have the same sizes.
        """
        for name, nominal in self.nominal.items():
            if model is None and nominal.size > _LARGE and world >= _FIRST and name not in self.values:
                continue
            now = flat(self.model if model is None else model, name)
            other = now != nominal
            if other.any() and nominal.dtype.kind == "f":
                other &= ~(np.isnan(now) & np.isnan(nominal))
            if not other.any():
                continue
            self.changed.add(name)
            self._grow(name, np.flatnonzero(other))
            self.values[name][:, world : world + count] = now[self.index[name], None]

    def take_numbers(self, world: int, name: str, index: Numbers, values: Numbers) -> None:
        """Record some numbers of an array from this world on, `(worlds, numbers)`."""
        self._grow(name, index)
        order = np.argsort(self.index[name])
        places = order[np.searchsorted(self.index[name], index, sorter=order)]
        self.values[name][places, world : world + len(values)] = values.T

    def _grow(self, name: str, other: Numbers) -> None:
        """Add numbers that differ for the first time: in earlier worlds they are nominal."""
        index = self.index.get(name, np.empty(0, np.int64))
        new = np.setdiff1d(other, index)
        if new.size or name not in self.values:
            rows = np.repeat(self.nominal[name][new][:, None], self.worlds, axis=1)
            self.index[name] = np.concatenate((index, new))
            self.values[name] = np.concatenate((self.values[name], rows)) if name in self.values else rows

    def extend(self, worlds: int) -> None:
        """Make room for this many worlds, which are nominal until something else is recorded."""
        more = max(0, worlds - self.worlds)
        self.worlds += more
        for name, values in self.values.items():
            rows = np.repeat(self.nominal[name][self.index[name]][:, None], more, axis=1)
            self.values[name] = np.concatenate((values, rows), axis=1)

    def restore(self) -> None:
        """Restore the nominal model."""
        for name in self.changed:
            put(self.model, name, self.nominal[name])
        self.changed.clear()

    def found(self) -> Iterator[tuple[str, Numbers, Numbers]]:
        """Yield for each differing array the flat indices, `(numbers,)`, and the numbers, `(worlds, numbers)`."""
        for name in sorted(self.values):
            order = np.argsort(self.index[name])
            yield name, self.index[name][order], np.ascontiguousarray(self.values[name][order].T)


def arrays(model: Model) -> Iterator[str]:
    """Yield all arrays of a model, its options, and the number that scales solver tolerances.

    The rest of `stat` is for viewers.
    """
    for name in dir(model):
        if not name.startswith("_") and isinstance(getattr(model, name), np.ndarray):
            yield name
    for name in dir(model.opt):
        if not name.startswith("_") and isinstance(getattr(model.opt, name), np.ndarray | float | int):
            yield f"opt.{name}"
    yield MEAN_INERTIA


def value_of(model: Model, name: str) -> Any:
    """Return an array of a model, or an array or number of its `opt.` or `stat.`. Raises AttributeError."""
    owner, _, field = name.rpartition(".")
    return getattr(getattr(model, owner) if owner else model, field)


def flat(model: Model, name: str) -> Numbers:
    """Return a flattened array: a view of the model's memory, or a copy of a single number."""
    value = value_of(model, name)
    numbers: Numbers = value.reshape(-1) if isinstance(value, np.ndarray) else np.array([value])
    return numbers


def put(model: Model, name: str, numbers: Numbers) -> None:
    """Write a whole array."""
    value = value_of(model, name)
    if isinstance(value, np.ndarray):
        value.reshape(-1)[:] = numbers
    else:
        owner, _, field = name.rpartition(".")
        setattr(getattr(model, owner), field, numbers[0].item())
