"""The addresses in one of MuJoCo's vectors, by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from composer.dataclass import dataclass
from composer.loading.numbers import Lookup, Names, unknown

Place: TypeAlias = int | slice | NDArray[np.intp]
"""An index into a vector or a batch of vectors: `qpos[place]`, `qpos[..., place]`."""

Range: TypeAlias = tuple[float, float]
UNLIMITED: Range = (-np.inf, np.inf)


@dataclass(frozen=True, slots=True)
class Entry:
    """One element of the model in a vector: `units` and `limits` have an item for each of its numbers.

    `body` is its body, `origin` where it is written; each is None if it does not apply or is unknown.
    """

    name: str
    start: int
    units: tuple[str | None, ...]
    limits: tuple[Range, ...]
    body: str | None = None
    origin: str | None = None

    @property
    def size(self) -> int:
        """The number of its values."""
        return len(self.units)


class Vector:
    """One vector of MuJoCo (`qpos`, `ctrl`, …), by name.

    `index.qpos["elbow"]` is an int if the element has one number, else a slice; `index.qpos["a", "b"]` and globs
    (`index.qpos["left/*"]`) are an array of all their numbers, shape (n,). All three index a single vector,
    `data.qpos[place]`, and the last axis of a batch, `qpos[..., place]`.
    """

    def __init__(self, name: str, kind: str, entries: Sequence[Entry], separator: str) -> None:
        self.name = name
        self.entries = tuple(entries)
        self._lookup = Lookup(kind, [each.name for each in entries], separator)

    @property
    def names(self) -> tuple[str, ...]:
        """The names in the order of the vector; unnamed elements are ""."""
        return self._lookup.names

    @property
    def size(self) -> int:
        """The length of the vector."""
        return sum(each.size for each in self.entries)

    def __getitem__(self, names: Names) -> Place:
        """Return the addresses of the elements with these names or globs. Raises UnknownNameError, a KeyError."""
        if isinstance(names, str) and (row := self._lookup.row(names)) is not None:
            entry = self.entries[row]
            return entry.start if entry.size == 1 else slice(entry.start, entry.start + entry.size)
        return self._places(self._entries(names))

    def array(self, names: Names) -> NDArray[np.intp]:
        """Return the addresses as an array of shape (n,), even for one name."""
        return self._places(self._entries(names))

    def on(self, body: str) -> Place:
        """Return the addresses of the elements of a body, including unnamed joints. Raises UnknownNameError."""
        found = [each for each in self.entries if each.body == body]
        if not found:
            raise unknown(
                f"body with a {self._lookup.kind}", body, [each.body for each in self.entries if each.body]
            )
        start, end = found[0].start, found[-1].start + found[-1].size
        return start if end - start == 1 else slice(start, end)

    def limits(self, names: Names = "**") -> NDArray[np.float64]:
        """Return the least and greatest value of each number, shape (n, 2), infinite if not limited; in its unit."""
        limits = [pair for each in self._entries(names) for pair in each.limits]
        return np.array(limits, dtype=np.float64).reshape(-1, 2)

    def units(self, names: Names = "**") -> tuple[str | None, ...]:
        """Return the unit of each number: `rad`, `m`, `quaternion`, `N m`, …; None if it depends on the model."""
        return tuple(unit for each in self._entries(names) for unit in each.units)

    def origin(self, name: str) -> str | None:
        """Return where an element is written, as FILE:LINE."""
        (entry,) = self._entries(name)[:1]
        return entry.origin

    def _entries(self, names: Names) -> list[Entry]:
        if names == "**":
            return list(self.entries)
        return [self.entries[row] for row in self._lookup.rows(names)]

    @staticmethod
    def _places(entries: Sequence[Entry]) -> NDArray[np.intp]:
        return np.array(
            [place for each in entries for place in range(each.start, each.start + each.size)], dtype=np.intp
        )

    def __contains__(self, name: object) -> bool:
        return name in self._lookup

    def __iter__(self) -> Iterator[str]:
        return iter(self._lookup)

    def __len__(self) -> int:
        return len(self.entries)

    def __repr__(self) -> str:
        return f"<{self.name}: {self.size} numbers of {len(self)} × {self._lookup.kind}>"
