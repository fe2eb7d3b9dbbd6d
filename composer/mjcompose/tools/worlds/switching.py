"""Give worlds of MuJoCo Warp other cells, in place."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.suggest import did_you_mean
from mjcompose.tools.worlds.names import failure
from mjcompose.tools.worlds.shares import worlds_of_cells
from mjcompose.tools.worlds.simulators import per_world
from mjcompose.tools.worlds.start import of_arrays, put_starts
from mjcompose.tools.worlds.worlds import Worlds


def switch(model: Any, data: Any, study: Worlds, worlds: Iterable[int], cells: Iterable[int | str]) -> Worlds:
    """Give some worlds of `worlds.warp(study)` and `worlds.warp_data(study)` other cells; return the new worlds.

        study = worlds.switch(model, data, study, worlds=[3, 8], cells=["mug", "can"])

    Cells are numbers or names of `study.table.cells`. Numbers are written in place, so CUDA graphs stay valid, and the
    state of a world stays: reset it. Worlds of one cell get its samples in turn. Raises LoadError, IndexError.
    """
    chosen = np.fromiter(worlds, np.int64)
    pool = study.pool or study
    wanted = _numbers(pool, cells)
    if chosen.shape != wanted.shape:
        raise ValueError(f"there are {chosen.size} worlds and {wanted.size} cells")
    if chosen.size and not 0 <= chosen.min() <= chosen.max() < study.count:
        raise IndexError(f"world {chosen.max()} does not exist: there are {study.count}")
    rows = worlds_of_cells(pool.table.cell, wanted, chosen.tolist())
    for name in per_world(model, study):
        owner, _, field = name.rpartition(".")
        array = getattr(getattr(model, owner) if owner else model, field)
        host = array.numpy()
        numbers = host.reshape(study.count, -1)
        varying = pool.arrays[name]
        numbers[chosen[:, None], varying.index] = varying.values[rows]
        array.assign(numbers.reshape(host.shape))
    put_starts(data, study.nominal, of_arrays(pool.take(rows.tolist()).arrays), chosen.tolist(), state=False)
    return study.with_rows(chosen, pool, rows)


def _numbers(pool: Worlds, cells: Iterable[int | str]) -> NDArray[np.int64]:
    names = [str(cell.get("name")) for cell in pool.table.cells]
    found = []
    for cell in cells:
        if isinstance(cell, str) and cell not in names:
            raise failure("unknown-name", f"the worlds have no cell `{cell}`", did_you_mean(cell, names))
        number = names.index(cell) if isinstance(cell, str) else int(cell)
        if number not in pool.table.cell:
            raise IndexError(f"cell {number} does not exist: there are {len(names)}")
        found.append(number)
    return np.array(found, np.int64)
