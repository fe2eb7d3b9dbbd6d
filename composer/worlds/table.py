"""A table of worlds: the numbers of `mjModel` that differ, and what belongs to each world."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from composer.dataclass import dataclass
from composer.expr.value import Value

FORMAT = 1


@dataclass(frozen=True, slots=True)
class Varying:
    """The numbers of one array that vary.

    `index` are their places in the flattened array, `(numbers,)`. `values` are absolute and in the array's units,
    `(worlds, numbers)`.
    """

    index: NDArray[np.int64]
    values: NDArray[Any]


@dataclass(frozen=True, slots=True)
class Table:
    """The numbers that differ, by array, in `count` worlds; and the cell and sample of the recipe for each world.

    `cells` are the cells of its matrix, each with its `name` and its values, `cell` the number of each world's
    cell, `(worlds,)`, and `sample` the number of its sample. For a union, `parts` are the bodies that not all
    worlds have, and `has` says which each has, `(worlds, parts)`. `model` is the identity of the model, None in a
    bundle that contains it.
    """

    arrays: Mapping[str, Varying]
    count: int
    seed: int | None = None
    cells: tuple[Mapping[str, Value | None], ...] = ()
    cell: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    sample: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    model: str | None = None
    mujoco: str | None = None
    parts: tuple[str, ...] = ()
    has: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((0, 0), np.bool_))

    def about(self) -> dict[str, Any]:
        """Return everything except the arrays, for JSON."""
        return {
            "worlds": FORMAT, "samples": self.count, "seed": self.seed, "mujoco": self.mujoco,
            "model_sha256": self.model, "cells": list(map(dict, self.cells)),
            "parts": list(self.parts), "has": self.has.astype(int).tolist() if self.parts else [],
        }  # fmt: skip


def of_about(about: Mapping[str, Any], arrays: Mapping[str, Varying], **given: Any) -> Table:
    """Return the table for the data in a file. Raises KeyError, TypeError, ValueError."""
    if about["worlds"] != FORMAT:
        raise ValueError(f"its format is {about['worlds']}, this mjcompose knows {FORMAT}")
    count = int(about["samples"])
    given = {"cell": np.zeros(count, np.int64), "sample": np.arange(1, count + 1), **given}
    parts = tuple(about.get("parts", ()))
    return Table(arrays, count, about["seed"], cells=tuple(about.get("cells", ())), **given,
                 model=about.get("model_sha256"), mujoco=about.get("mujoco"), parts=parts,
                 has=np.array(about.get("has", ()), np.bool_).reshape(count if parts else 0, len(parts)))  # fmt: skip
