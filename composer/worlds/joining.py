"""Join separately built models, and worlds of several models, to worlds of the first of them."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from composer.bundle.listing import SIZES
from composer.compiled.kinds import KINDS, Model, names
from composer.compiled.varying import Differences, arrays, flat
from composer.dataclass import dataclass
from composer.expr.value import Value
from composer.loading.load import Loaded
from composer.worlds.errors import failure
from composer.worlds.identity import model_sha256
from composer.worlds.parts import CODE, shape_of
from composer.worlds.table import Table, Varying
from composer.worlds.worlds import Worlds

_SHOWN = 4


class Joined(NamedTuple):
    """One model that becomes a world, or with a table several; its name, its cell and its sample."""

    loaded: Loaded
    name: str
    cell: Mapping[str, Value | None]
    sample: int
    table: Table | None = None
    folder: Path | None = None


@dataclass(slots=True)
class Group:
    """Models that differ from the `first` one in numbers only: what differs, and which worlds they are.

    For a union they also have the same `shape`: geoms of the same types and with the same meshes.
    """

    first: Joined
    differences: Differences
    shape: Hashable = None
    worlds: list[int] = field(default_factory=list)

    def take(self, each: Joined, first: int, count: int) -> None:
        """Add a model as `count` worlds from the `first`."""
        taken = len(self.worlds)
        self.differences.extend(taken + count)
        self.differences.take(taken, each.loaded.model, count)
        for name, own in each.table.arrays.items() if each.table is not None else ():
            self.differences.take_numbers(taken, name, own.index, values=own.values)
        self.worlds += range(first, first + count)

    def varying(self) -> Iterator[tuple[str, Varying]]:
        """Yield the numbers that differ, by array."""
        for name, index, values in self.differences.found():
            if not _is_of_names(name):
                yield name, Varying(index, values[: len(self.worlds)])


@dataclass(slots=True)
class Joining:
    """Joins models one by one, `expected` or more; also models with other elements if it `unites` them."""

    expected: int
    unites: bool = False
    groups: list[Group] = field(default_factory=list)
    _cells: list[Mapping[str, Value | None]] = field(default_factory=list)
    _cell: list[int] = field(default_factory=list)
    _sample: list[int] = field(default_factory=list)

    def add(self, each: Joined) -> bool:
        """Add a model; return whether it must be kept. Raises LoadError if it is another model."""
        model = each.loaded.model
        shape = shape_of(model, each.name) if self.unites else None
        alike = (
            one for one in self.groups if one.shape == shape and unlike(one.first.loaded.model, model) is None
        )
        group = next(alike, None)
        is_new = group is None
        if group is None:
            if self.groups and not self.unites:
                raise _other(self.groups[0].first, each)
            group = Group(each, Differences(model, 1 if self.unites else self.expected), shape)
            self.groups.append(group)
        if each.cell not in self._cells:
            self._cells.append(each.cell)
        count = 1 if each.table is None else each.table.count
        group.take(each, len(self._cell), count)
        self._cell += [self._cells.index(each.cell)] * count
        self._sample += [each.sample] if each.table is None else each.table.sample.tolist()
        return is_new

    def worlds(self) -> Worlds:
        """Return the worlds of the common model."""
        (group,) = self.groups
        loaded = group.first.loaded
        return Worlds(
            loaded.model, loaded.manifest, loaded.index, table=self.table(loaded, dict(group.varying()))
        )

    def table(self, loaded: Loaded, varying: Mapping[str, Varying]) -> Table:
        """Return a table of the differences from a model."""
        first = self.groups[0].first
        seed = first.loaded.manifest.seed if first.table is None else first.table.seed
        return Table(varying, len(self._cell), seed, cells=tuple(self._cells), cell=np.array(self._cell, np.int64),
                     sample=np.array(self._sample, np.int64), model=model_sha256(loaded.manifest),
                     mujoco=loaded.manifest.mujoco)  # fmt: skip


def join(found: Iterable[Joined], expected: int) -> Worlds:
    """Return these models, `expected` or more, as worlds of the first one's model.

    Raises LoadError for another model.
    """
    joining = Joining(expected)
    for each in found:
        joining.add(each)
    return joining.worlds()


def _other(first: Joined, other: Joined) -> Exception:
    why = unlike(first.loaded.model, other.loaded.model)
    help = "build these cells by themselves with `--pick`, or let one model have the parts of all: write `emit: union`"
    message = f"`{other.name}` cannot be a world of `{first.name}`: it is another model"
    return failure(CODE, message, help, notes=why or ())


def unlike(first: Model, other: Model) -> list[str] | None:
    """Return why a model is another one, or None if only numbers differ."""
    why = []
    for kind in KINDS:
        here, there = names(first, kind), names(other, kind)
        if here == there:
            continue
        known, found = set(here), set(there)
        why += [f"it has the {kind} `{name}`" for name in there if name not in known][:_SHOWN]
        why += [f"it lacks the {kind} `{name}`" for name in here if name not in found][:_SHOWN]
        if known == found:
            why.append(f"it has {len(there)} {kind}s in another order or number")
    if why:
        return why[: 2 * _SHOWN]
    for size in SIZES:
        if getattr(first, size) != getattr(other, size):
            return [f"`{size}` is {getattr(other, size)}, not {getattr(first, size)}"]
    for name in arrays(first):
        if (now := flat(other, name).size) != (before := flat(first, name).size):
            return [f"the array `{name}` has {now} numbers, not {before}"]
    return None


def _is_of_names(array: str) -> bool:
    """Return whether an array holds positions of names and file paths in a text that begins with the model's name."""
    return array.startswith("name") or array.endswith("pathadr")
