"""Numbers and settings in which compiled models differ, and their owners.

A part is not changed if the `option` and `visual` of its model differ, but its author wrote them for a reason.
"""

from __future__ import annotations

import ctypes
import operator
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mjcompose.mujoco.addresses import RUNS
from mjcompose.mujoco.attributes import KIND_OF, KINDS, TAGS, NameTable, array_of, attributes
from mjcompose.mujoco.unequal import unequal

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_ATTRIBUTES = {array_of(tag, attribute): attribute for tag in TAGS for attribute in attributes(tag)}
_OWNERS = {"opt": "option", "stat": "statistic"}


Rows = dict[int, tuple[int, int, int]]
"""By row of an array: its element, its place among that element's rows, and the number of these rows."""


class Whose(NamedTuple):
    """An element by kind and name, `arm/elbow`, and its attribute or a number of it, `friction[0]`.

    If MJCF has no attribute for it, the array's name is used: `invweight0[1]`. Options are a kind without names.
    """

    kind: str
    element: str
    attribute: str


def whose(model: MjModel, array: str, index: Iterable[int]) -> list[Whose]:
    """Return the owner of each number of an array, by its flat index."""
    owner, _, field = array.rpartition(".")
    value = np.asarray(value_of(model, array))
    if owner:
        return [Whose(_OWNERS[owner], "", field if value.size == 1 else f"{field}[{each}]") for each in index]
    kind, rows = owners(model, array)
    named = _ATTRIBUTES.get(array, array.partition("_")[2] or array)
    table = NameTable(model)
    width = int(np.prod(value.shape[1:], dtype=int))
    found = []
    for each in map(int, index):
        row, column = divmod(each, width)
        if row not in rows:
            found.append(Whose(kind, "", f"{named}[{each}]"))
            continue
        element, place, count = rows[row]
        attribute = named if width * count == 1 else f"{named}[{place * width + column}]"
        found.append(Whose(kind, table.describe(kind, element), attribute))
    return found


def owners(model: MjModel, array: str) -> tuple[str, Rows]:
    """Return the kind of element that an array is about, and the owner of each row; none if that is unknown."""
    kind = KIND_OF.get(array.split("_", 1)[0], "")
    return kind, rows_of_size(model, kind, len(value_of(model, array))) if kind else {}


def rows_of_size(model: MjModel, kind: str, rows: int) -> Rows:
    """Return the owner of each row, for an array with this many rows about elements of a kind."""
    count = len(getattr(model, KINDS[kind].addresses))
    if rows == count:
        return {row: (row, 0, 1) for row in range(rows)}
    found: Rows = {}
    for size, run in RUNS.get(kind, {}).items():
        if getattr(model, size, None) == rows and hasattr(model, run.first):
            for element in range(count):
                own = run.rows(model, element)
                found |= {row: (element, place, len(own)) for place, row in enumerate(own)}
    return found


def places_of_rows(array: NDArray[Any], rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the flat indices of all numbers in these rows of an array."""
    width = int(np.prod(array.shape[1:], dtype=int))
    return (rows[:, None] * width + np.arange(width)).ravel()


Numbers = NDArray[Any]
MEAN_INERTIA = "stat.meaninertia"
"""The number that scales the tolerances of solvers."""
MEAN_MASS = "stat.meanmass"
"""The number that scales forces in viewers."""
MEANS = (MEAN_INERTIA, MEAN_MASS)
_LARGE = 1 << 16
_FIRST = 4
"""Larger arrays are assets, such as the vertices of meshes. For draws they are only compared in these first worlds."""
_WORD = 8
_BLOCK = 2048
_PADDED = 64
"""MuJoCo allocates memory in multiples of this number of bytes."""


class Differences:
    """The differences from the nominal model in this many worlds: by array, the numbers that differ in any world."""

    def __init__(self, model: MjModel, worlds: int) -> None:
        self.worlds = worlds
        self.nominal = {name: flat(model, name).copy() for name in arrays(model)}
        self.index: dict[str, Numbers] = {}
        self.values: dict[str, Numbers] = {}

    def take(self, world: int, model: MjModel, count: int = 1) -> None:
        """Record a model with arrays of the same sizes for `count` worlds from this one."""
        for name, nominal in self.nominal.items():
            now = flat(model, name)
            other = unequal(nominal, now)
            if other.any():
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

    def found(self) -> Iterator[tuple[str, Numbers, Numbers]]:
        """Yield for each differing array the flat indices, `(numbers,)`, and the numbers, `(worlds, numbers)`."""
        for name in sorted(self.values):
            order = np.argsort(self.index[name])
            yield name, self.index[name][order], np.ascontiguousarray(self.values[name][order].T)


class Recorder:
    """Records the state of one model world by world, and restores the nominal model after each world.

    MuJoCo keeps all arrays of a model in one buffer, from which they are compared in one step. The options and
    numbers of `stat` are elsewhere.
    """

    def __init__(self, model: MjModel) -> None:
        self.worlds = 0
        self._model = model
        places = {name: _span(model, name) for name in arrays(model) if "." not in name}
        used = {name: span for name, span in places.items() if span[0] < span[1]}
        start = min(first for first, _ in used.values())
        size = -(-(max(end for _, end in used.values()) - start) // _WORD) * _WORD
        if size >= model.nbuffer + _PADDED or any((first - start) % _WORD for first, _ in used.values()):
            raise RuntimeError("this version of MuJoCo arranges the arrays of a model in another way")
        self._spans = {name: (first - start, end - start) for name, (first, end) in used.items()}
        self._bytes = np.ctypeslib.as_array((ctypes.c_uint8 * size).from_address(start))
        self._now = self.view(np.dtype(np.uint64))
        self._nominal = self._now.copy()
        self._ranges = [(0, len(self._now))]
        self._words = np.empty(0, np.int64)
        self._blocks: list[Numbers] = []
        self._means: list[tuple[float, ...]] = []
        self._nominal_means = _means(model)
        names = [name for name in arrays(model) if name.startswith("opt.")]
        views = {name: value for name in names if isinstance(value := value_of(model, name), np.ndarray)}
        self._options = list(views.values())
        self._numbers = operator.attrgetter(*(name[4:] for name in names if name not in views))
        self._nominal_options = self._options_now()

    def view(self, dtype: np.dtype[Any]) -> Numbers:
        """Return the memory of all arrays as numbers of one type."""
        return self._bytes.view(dtype)

    def first_of(self, name: str) -> int:
        """Return the index of an array's first number in the view of its type."""
        first: int = self._spans[name][0] // getattr(self._model, name).itemsize
        return first

    def take(self) -> None:
        """Record the model's state as the next world, and restore the nominal model."""
        row = self.worlds % _BLOCK
        if row == 0:
            self._blocks.append(np.empty((_BLOCK, len(self._words)), np.uint64))
        if self.worlds == _FIRST:
            self._leave_out_assets()
        now = self._now
        block = self._blocks[-1]
        block[row] = now[self._words]
        now[self._words] = self._nominal[self._words]
        new = [
            first + np.flatnonzero(now[first:end] != self._nominal[first:end])
            for first, end in self._ranges
            if not (now[first:end] == self._nominal[first:end]).all()
        ]
        if new:
            words = np.concatenate(new)
            more = np.repeat(self._nominal[words][None, :], _BLOCK, axis=0)
            more[row] = now[words]
            self._blocks[-1] = np.concatenate((block, more), axis=1)
            self._words = np.concatenate((self._words, words))
            now[words] = self._nominal[words]
        if self._options_now() != self._nominal_options:
            raise RuntimeError("a draw changes an option of the model")
        self._means.append(_means(self._model))
        self._model.stat.meaninertia, self._model.stat.meanmass = self._nominal_means
        self.worlds += 1

    def found(self) -> Iterator[tuple[str, Numbers, Numbers]]:
        """Yield for each differing array the flat indices, `(numbers,)`, and the numbers, `(worlds, numbers)`."""
        order = np.argsort(self._words)
        words = self._words[order]
        for name in sorted((*self._spans, *MEANS)):
            if name in MEANS:
                at = MEANS.index(name)
                means = np.array([each[at] for each in self._means])[:, None]
                if unequal(np.array([self._nominal_means[at]]), means).any():
                    yield name, np.zeros(1, np.int64), means
                continue
            first, end = self._spans[name]
            ours = slice(*np.searchsorted(words, (first // _WORD, -(-end // _WORD))))
            if ours.start == ours.stop:
                continue
            nominal = flat(self._model, name)
            starts = (words[ours] * _WORD - first) // nominal.itemsize
            index = (starts[:, None] + np.arange(_WORD // nominal.itemsize)).reshape(-1)
            rows = np.empty((self.worlds, len(index)), nominal.dtype)
            for number, block in enumerate(self._blocks):
                part = rows[number * _BLOCK : (number + 1) * _BLOCK]
                part[:] = self._columns(block, order[ours], words[ours])[: len(part)].view(nominal.dtype)
            inside = index < nominal.size
            inside[inside] = unequal(nominal[index[inside]], rows[:, inside]).any(axis=0)
            if inside.any():
                yield name, index[inside], np.ascontiguousarray(rows[:, inside])

    def _columns(self, block: Numbers, places: Numbers, words: Numbers) -> Numbers:
        """Return columns of a block; words that were not known when it ended are nominal."""
        known = places < block.shape[1]
        rows = np.repeat(self._nominal[words][None, :], len(block), axis=0)
        rows[:, known] = block[:, places[known]]
        return rows

    def _leave_out_assets(self) -> None:
        """Stop comparing large arrays in which nothing has differed."""
        self._ranges = []
        at = 0
        for name, (first, end) in sorted(self._spans.items(), key=lambda each: each[1]):
            is_known = ((self._words * _WORD < end) & (self._words * _WORD + _WORD > first)).any()
            if getattr(self._model, name).size > _LARGE and not is_known:
                self._ranges.append((at, first // _WORD))
                at = -(-end // _WORD)
        self._ranges.append((at, len(self._now)))

    def _options_now(self) -> tuple[object, ...]:
        return self._numbers(self._model.opt), *(each.tobytes() for each in self._options)


def _means(model: MjModel) -> tuple[float, float]:
    return model.stat.meaninertia, model.stat.meanmass


def _span(model: MjModel, name: str) -> tuple[int, int]:
    array = getattr(model, name)
    first = array.__array_interface__["data"][0]
    return first, first + array.nbytes


def arrays(model: MjModel) -> Iterator[str]:
    """Yield all arrays of a model, its options, and the numbers of `stat` that follow from masses."""
    for holder, start, kinds in ((model, "", np.ndarray), (model.opt, "opt.", np.ndarray | float | int)):
        for name in dir(holder):
            if not name.startswith("_") and isinstance(getattr(holder, name), kinds):
                yield start + name
    yield from MEANS


def value_of(model: MjModel, name: str) -> Any:
    """Return an array of a model, or an array or number of its `opt.` or `stat.`. Raises AttributeError."""
    return operator.attrgetter(name)(model)


def flat(model: MjModel, name: str) -> Numbers:
    """Return a flattened array: a view of the model's memory, or a copy of a single number."""
    value = value_of(model, name)
    numbers: Numbers = value.reshape(-1) if isinstance(value, np.ndarray) else np.array([value])
    return numbers


def put(model: MjModel, name: str, numbers: Numbers) -> None:
    """Write a whole array."""
    value = value_of(model, name)
    if isinstance(value, np.ndarray):
        value.reshape(-1)[:] = numbers
    else:
        owner, _, field = name.rpartition(".")
        setattr(getattr(model, owner), field, numbers[0].item())


def stored(model: MjModel, found: Iterable[tuple[str, Numbers, Numbers]]) -> dict[str, Numbers]:
    """Return the entries of an `.npz` file by key.

    For every array NAME there are `NAME/index`, the numbers' places in the flattened array, `(numbers,)`, and
    `NAME/values`, `(worlds, numbers)`. For readers there are `NAME/kind`, `NAME/element` and `NAME/attribute`,
    `(numbers,)`, with the owner of each number.
    """
    arrays: dict[str, Numbers] = {}
    for name, index, values in found:
        owners = whose(model, name, index)
        arrays |= {
            f"{name}/index": index,
            f"{name}/kind": np.array(owners[0].kind if owners else ""),
            f"{name}/element": np.array([each.element for each in owners], str),
            f"{name}/attribute": np.array([each.attribute for each in owners], str),
            f"{name}/values": values,
        }
    return arrays
