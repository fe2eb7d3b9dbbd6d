"""Tables of worlds in files: `.npz`, which needs only NumPy, or `.parquet` with a row for each world."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.compiled.kinds import Model
from composer.compiled.stored import stored
from composer.expr.value import Value

FORMAT = 1
_ABOUT = "about.json"


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


def write(path: str | PathLike[str], model: Model, table: Table) -> None:
    """Write a table completely or not at all: as Parquet if the name says so, else as `.npz`. Raises OutputError."""
    path = Path(path)
    check_name(path)
    with staged_file(path) as stage:
        if path.suffix.lower() == ".parquet":
            from composer.worlds.parquet import write_parquet

            write_parquet(stage, model, table)
            return
        found = ((name, varying.index, varying.values) for name, varying in sorted(table.arrays.items()))
        about = np.frombuffer(json.dumps(table.about()).encode(), np.uint8)
        arrays: dict[str, Any] = {
            _ABOUT: about,
            "cell": table.cell,
            "sample": table.sample,
            **stored(model, found),
        }
        with stage.open("wb") as file:
            np.savez(file, allow_pickle=False, **arrays)


def check_name(path: Path) -> None:
    """Raise OutputError for a name that is not that of a table of worlds."""
    if path.suffix.lower() not in (".npz", ".parquet"):
        help = f"end it in `.npz`, or in `.parquet` with `pyarrow` installed: `{path.with_suffix('.npz')}`"
        raise OutputError("output-kind", f"no table of worlds is called `*{path.suffix}`: `{path}`", help)
    if path.suffix.lower() == ".parquet":
        from composer.worlds.parquet import check_installed

        check_installed()


def read(content: bytes) -> Table:
    """Parse a table. Raises ValueError, KeyError, TypeError or OSError for anything else."""
    if content.startswith(b"PAR1"):
        from composer.worlds.parquet import read_parquet

        return read_parquet(content)
    try:
        with np.load(BytesIO(content), allow_pickle=False) as file:
            about = json.loads(bytes(file[_ABOUT]))  # text beside the arrays, or an array of its bytes
            names = sorted({each.rpartition("/")[0] for each in file.files if "/" in each})
            arrays = {name: Varying(file[f"{name}/index"], file[f"{name}/values"]) for name in names}
            given = {each: file[each] for each in ("cell", "sample") if each in file.files}
    except zipfile.BadZipFile as error:
        raise ValueError(str(error)) from error
    return of_about(about, arrays, **given)


def of_about(about: Mapping[str, Any], arrays: Mapping[str, Varying], **given: Any) -> Table:
    """Return the table for the data in a file. Raises KeyError, TypeError, ValueError."""
    if about["worlds"] != FORMAT:
        raise ValueError(f"its format is {about['worlds']}, this mjcompose knows {FORMAT}")
    count = int(about["samples"])
    given = {"cell": np.zeros(count, np.int64), "sample": np.arange(1, count + 1), **given}
    parts = tuple(about.get("parts", ()))
    return Table(arrays, count, about["seed"], tuple(about.get("cells", ())), **given,
                 model=about.get("model_sha256"), mujoco=about.get("mujoco"), parts=parts,
                 has=np.array(about.get("has", ()), np.bool_).reshape(count if parts else 0, len(parts)))  # fmt: skip
