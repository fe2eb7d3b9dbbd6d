"""Rows that are not evenly spaced, as one array that writes changes back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from composer.dataclass import dataclass

_Number = TypeVar("_Number", bound=np.generic)


class Scattered(np.ndarray[Any, np.dtype[Any]]):
    """A copy of some rows of one of MuJoCo's arrays, made when it was read.

    Assigned items and slices, and `+=` and the like, are also written to MuJoCo's array, and only these: what
    numpy's functions write (`out=`, `fill`, `sort`) is not. Results computed from it are separate arrays.
    """

    __slots__ = ("home",)
    home: Home[Any]

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(key, value)
        self._write_back(key)

    def _write_back(self, key: Any = ...) -> None:
        """Write back only the numbers that were assigned, since the others may have changed after they were read."""
        rows: Any = self
        while getattr(rows, "home", None) is None:
            rows = rows.base
            if not isinstance(rows, Scattered):
                return  # computed from rows, or in memory that is shared with none
        source = rows.home.source
        if self is rows and source.ndim == 1:
            source[rows.home.index[key]] = np.asarray(self)[key]
        else:
            width = source[0].size
            at = places(rows, self)[key]
            written = rows.home.index[at // width]
            rows.home.before(written)
            np.put(source, written * width + at % width, np.asarray(self)[key])


def places(of: NDArray[Any], view: NDArray[Any]) -> NDArray[np.intp]:
    """Return the flat indices in `of` of the items of a view of it, in the shape of the view. `of` is contiguous."""
    found = np.array((view.ctypes.data - of.ctypes.data) // of.itemsize, dtype=np.intp)
    for length, stride in zip(view.shape, view.strides, strict=True):
        found = found[..., None] + np.arange(length) * (stride // of.itemsize)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Home(Generic[_Number]):
    """The origin of scattered rows: the rows `index`, an array of integers, of `source`.

    `before` is called with the rows that are about to be written; rows with several numbers may be repeated.
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
        """Return the current values of the rows."""
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
