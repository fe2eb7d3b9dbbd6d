"""Tables of worlds in files: `.npz`, which needs only NumPy, or `.parquet` with a row for each world."""

from __future__ import annotations

import json
import zipfile
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.compiled.kinds import Model
from composer.compiled.stored import stored
from composer.worlds.table import Table, Varying, of_about

_ABOUT = "about.json"


def write(path: str | PathLike[str], model: Model, table: Table, option: str | None = None) -> None:
    """Write a table completely or not at all: as Parquet if the name says so, else as `.npz`. Raises OutputError."""
    path = Path(path)
    check_name(path)
    with staged_file(path, option) as stage:
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
