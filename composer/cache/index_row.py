"""The row of a model in the index of a run, `models.csv`."""

from __future__ import annotations

import os

from composer.bundle.listing import SIZES, column
from composer.cache.result import Made
from composer.expand.matrix import Cell
from composer.expr.value import Value

Row = tuple[list[Value | None], dict[str, Value]]


def index_row(cell: Cell, made: Made, path: str, checks: int) -> Row:
    """Return the values of the columns that every model has (`bundle/listing.py`), and the other columns by name.

    The latter are the values of the matrix and of draws, with one column for each number of a vector.
    """
    sizes = made.sizes or {}
    sample = cell.sample if cell.is_sample else None
    about = [cell.name, cell.cell, sample, path.replace(os.sep, "/"), made.sha256, made.mujoco, checks]
    return [*about, *(sizes.get(name) for name in SIZES)], _values(cell, made)


def _values(cell: Cell, made: Made) -> dict[str, Value]:
    given = {name: value for name, value in cell.values().items() if value is not None}
    found: dict[str, Value] = {}
    for name, value in {**given, **(made.draws or {})}.items():
        if isinstance(value, tuple):
            found |= {f"{column(name)}[{number}]": each for number, each in enumerate(value)}
        else:
            found[column(name)] = value
    return found
