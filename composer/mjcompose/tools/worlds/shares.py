"""How many worlds each cell gets, and which of its worlds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.text.expression import Value
from mjcompose.tools.worlds.names import failure

Weights: TypeAlias = Mapping[str, Mapping[Value, float]]
"""By axis and value; other values have the weight 1."""
Cells: TypeAlias = Sequence[Mapping[str, Value | None]]


def weights_of(cells: Cells, weights: Weights) -> NDArray[np.float64]:
    """Return the weight of each cell, the product of the weights of its values. Raises LoadError."""
    found = np.ones(len(cells))
    for axis, chosen in weights.items():
        values = [cell.get(axis) for cell in cells]
        if all(value is None for value in values):
            axes = sorted({name for cell in cells for name in cell} - {"name"})
            raise failure("unknown-name", f"the worlds have no axis `{axis}`", did_you_mean(axis, axes))
        known = sorted({str(value) for value in values})
        for value, weight in chosen.items():
            has = np.array([each == value or str(each) == str(value) for each in values])
            if not has.any():
                message = f"`weights.{axis}` has `{value}`, which is not a value of the axis"
                note = exists_note("value", known, str(value)).message
                raise failure("out-of-range", message, did_you_mean(str(value), known), notes=[note])
            if not 0 <= weight < np.inf:
                raise failure("out-of-range", f"the weight of `{value}` is {weight}", "write 0 or more")
            found[has] *= weight
    if not found.any():
        raise failure("out-of-range", "all weights are 0", "give one cell a weight")
    return found


def shared_out(count: int, weights: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the cell of each of `count` worlds: shares by largest remainder, and each cell spread over all worlds."""
    quotas = weights / weights.sum() * count
    shares = np.floor(quotas).astype(int)
    shares[np.argsort(shares - quotas, kind="stable")[: count - shares.sum()]] += 1
    cells = np.repeat(np.arange(len(shares)), shares)
    places = np.concatenate([(np.arange(share) + 0.5) / share for share in shares if share] or [np.zeros(0)])
    return cells[np.argsort(places, kind="stable")]


def worlds_of_cells(cell: NDArray[np.int64], wanted: NDArray[np.int64], places: Iterable[int]) -> NDArray[np.int64]:
    """Return a world of each `wanted` cell; `cell` has the cell of each world.

    A place, counted from 0, says which sample of the cell it is; after the last sample comes the first one again.
    """
    samples = {number: np.flatnonzero(cell == number) for number in np.unique(wanted).tolist()}
    return np.array(
        [samples[each][place % len(samples[each])] for each, place in zip(wanted.tolist(), places, strict=True)],
        np.int64,
    )
