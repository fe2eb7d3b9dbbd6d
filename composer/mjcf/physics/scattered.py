"""Rows that do not stand side by side, as one array that writes back what is written to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

_Number = TypeVar("_Number", bound=np.generic)


class Scattered(np.ndarray[Any, np.dtype[Any]]):
    """A copy of some rows of an array of MuJoCo, taken when it was asked for.

    Items, slices and `+=` and the like are written to MuJoCo's array as well; what numpy's functions write
    (`out=`, `fill`, `sort`) is not. What is computed from it is an array of its own.
    """

    __slots__ = ("home",)
    home: Home[Any]

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(key, value)
        self._write_back()

    def _write_back(self) -> None:
        """A slice of rows is memory of the rows: those are written as a whole."""
        rows: Any = self
        while isinstance(rows, Scattered):
            home = getattr(rows, "home", None)
            if home is not None:
                home.source[home.index] = rows
                return
            rows = rows.base


@dataclass(frozen=True, slots=True, eq=False)
class Home(Generic[_Number]):
    """Where scattered rows belong: the rows `index`, an array of integers, of `source`."""

    source: NDArray[_Number]
    index: NDArray[np.intp]
    flat: bool

    @classmethod
    def of(cls, array: NDArray[_Number], index: NDArray[np.intp]) -> Home[_Number]:
        return cls(array.view(Scattered), index, array.ndim == 1)

    def read(self) -> Scattered:
        """The rows as they are now."""
        # Indexing is fast for numbers, `take` for rows of several.
        rows: Any = self.source[self.index] if self.flat else self.source.take(self.index, 0)
        rows.home = self
        return rows  # type: ignore[no-any-return]

    def write(self, value: object) -> None:
        source: Any = self.source
        source[self.index] = value


def _in_place(name: str) -> Any:
    compute = getattr(np.ndarray, name)

    def write(self: Scattered, other: object) -> Any:
        result = compute(self, other)
        self._write_back()
        return result

    write.__name__ = name
    return write


for _operator in "add sub mul truediv floordiv mod pow and or xor lshift rshift".split():
    setattr(Scattered, f"__i{_operator}__", _in_place(f"__i{_operator}__"))
