"""Rows that do not stand side by side, as one array that writes back what is written to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

_Number = TypeVar("_Number", bound=np.generic)


class Scattered(np.ndarray[Any, np.dtype[Any]]):
    """A copy of some rows of an array of MuJoCo, taken when it was asked for.

    Items, slices and `+=` and the like are written to MuJoCo's array as well, and nothing but these; what
    numpy's functions write (`out=`, `fill`, `sort`) is not. What is computed from it is an array of its own.
    """

    __slots__ = ("home",)
    home: Home[Any]

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(key, value)
        self._write_back(key)

    def _write_back(self, key: Any = ...) -> None:
        """Only what was written: the other numbers are those of the time of reading."""
        rows: Any = self
        while getattr(rows, "home", None) is None:
            rows = rows.base
            if not isinstance(rows, Scattered):
                return  # computed from rows, or in memory that is shared with none
        source = rows.home.source
        if self is rows and source.ndim == 1:
            source[rows.home.index[key]] = np.asarray(self)[key]
        else:
            places = np.arange(source.size).reshape(source.shape)[rows.home.index]
            written = seen_alike(places, rows, self)[key]
            rows.home.before(np.unique(written // source.shape[-1]))
            np.put(source, written, np.asarray(self)[key])


def seen_alike(places: NDArray[np.intp], rows: NDArray[Any], view: NDArray[Any]) -> NDArray[np.intp]:
    """The part of `places` that a view of `rows`, an array of the same shape, shows of it; both lie in one piece."""
    offset = (view.ctypes.data - rows.ctypes.data) // rows.itemsize
    strides = [stride // rows.itemsize * places.itemsize for stride in view.strides]
    flat = places.reshape(-1)[offset : offset + 1] if view.size else places.reshape(-1)[:0]
    return np.lib.stride_tricks.as_strided(flat, view.shape, strides)


@dataclass(frozen=True, slots=True, eq=False)
class Home(Generic[_Number]):
    """Where scattered rows belong: the rows `index`, an array of integers, of `source`.

    `before` is called with the rows that are about to be written, where they have several numbers each.
    """

    source: NDArray[_Number]
    index: NDArray[np.intp]
    flat: bool
    before: Callable[[NDArray[np.intp]], None]

    @classmethod
    def of(
        cls,
        array: NDArray[_Number],
        index: NDArray[np.intp],
        before: Callable[[NDArray[np.intp]], None] = lambda rows: None,
    ) -> Home[_Number]:
        return cls(array.view(Scattered), index, array.ndim == 1, before)

    def read(self) -> Scattered:
        """The rows as they are now."""
        # Indexing is fast for numbers, `take` for rows of several.
        rows: Any = self.source[self.index] if self.flat else self.source.take(self.index, 0)
        rows.home = self
        return rows  # type: ignore[no-any-return]

    def write(self, value: object) -> None:
        source: Any = self.source
        if not self.flat:
            np.empty((len(self.index), *source.shape[1:]), source.dtype)[...] = value
            self.before(self.index)
        source[self.index] = value


def _in_place(name: str) -> Any:
    compute = getattr(np.ndarray, name)

    def write(self: Scattered, other: object) -> Any:
        result = compute(self, other)
        self._write_back()
        return result

    write.__name__ = name
    return write


IN_PLACE = [
    f"__i{operator}__" for operator in "add sub mul truediv floordiv mod pow and or xor lshift rshift".split()
]

for _name in IN_PLACE:
    setattr(Scattered, _name, _in_place(_name))
