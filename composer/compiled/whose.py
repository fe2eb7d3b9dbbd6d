"""The owner of a number of `mjModel`: the element, and the MJCF attribute."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from composer.compiled.addresses import RUNS
from composer.compiled.attributes import TAGS, array_of, attributes
from composer.compiled.kinds import KINDS, Model, NameTable
from composer.compiled.varying import value_of

_ATTRIBUTES = {array_of(tag, attribute): attribute for tag in TAGS for attribute in attributes(tag)}
_OWNERS = {"opt": "option", "stat": "statistic"}
_KIND_OF = {kind.arrays: word for word, kind in KINDS.items()} | {
    "dof": "joint", "qpos0": "joint", "qpos": "joint", "wrap": "tendon",
}  # fmt: skip


Rows = dict[int, tuple[int, int, int]]
"""By row of an array: its element, its place among that element's rows, and how many these are."""


class Whose(NamedTuple):
    """An element by kind and name, `arm/elbow`, and its attribute or a number of it, `friction[0]`.

    If MJCF has no attribute for it, the array's name is used: `invweight0[1]`. Options are a kind without names.
    """

    kind: str
    element: str
    attribute: str


def whose(model: Model, array: str, index: Iterable[int]) -> list[Whose]:
    """Return the owner of each number of an array, by its flat index."""
    owner, _, field = array.rpartition(".")
    shape = np.shape(value_of(model, array))
    width = int(np.prod(shape[1:], dtype=int))
    if owner:
        single = int(np.prod(shape, dtype=int)) == 1
        return [Whose(_OWNERS[owner], "", field if single else f"{field}[{each}]") for each in index]
    kind, rows = owners(model, array)
    named = _ATTRIBUTES.get(array, array.partition("_")[2] or array)
    table = NameTable(model) if rows else None
    found = []
    for each in map(int, index):
        row, column = divmod(each, width)
        if table is None or row not in rows:
            found.append(Whose(kind, "", f"{named}[{each}]"))
            continue
        element, place, count = rows[row]
        number = place * width + column
        name = table.describe(kind, element)
        found.append(Whose(kind, name, named if width * count == 1 else f"{named}[{number}]"))
    return found


def owners(model: Model, array: str) -> tuple[str, Rows]:
    """Return the kind of element that an array is about, and the owner of each row; none if that is unknown."""
    kind = _KIND_OF.get(array.split("_", 1)[0], "")
    return kind, rows_of_size(model, kind, len(value_of(model, array))) if kind else {}


def rows_of_size(model: Model, kind: str, rows: int) -> Rows:
    """Return the owner of each row, for an array with this many rows about elements of a kind."""
    count = len(getattr(model, KINDS[kind].addresses))
    if rows == count:
        return {row: (row, 0, 1) for row in range(rows)}
    return {row: where for size, row, where in _runs(model, kind, count) if getattr(model, size) == rows}


def _runs(model: Model, kind: str, count: int) -> Iterator[tuple[str, int, tuple[int, int, int]]]:
    for size, run in RUNS.get(kind, {}).items():
        if not hasattr(model, size) or not hasattr(model, run.first):
            continue
        for element in range(count):
            rows = run.rows(model, element)
            for place, row in enumerate(rows):
                yield size, row, (element, place, len(rows))
