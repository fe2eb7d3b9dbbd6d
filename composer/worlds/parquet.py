"""Tables of worlds as Parquet: a row for each world, and a column for each number, named after its element."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from composer.bundle.output_error import OutputError
from composer.compiled.kinds import Model
from composer.compiled.whose import whose
from composer.worlds.table import Table, Varying, of_about

_ABOUT, _ARRAY, _INDEX = b"mjcompose", b"array", b"index"


def check_installed() -> Any:
    """Return `pyarrow`. Raises OutputError without it."""
    try:
        import pyarrow.parquet
    except ImportError:
        help = "`pip install pyarrow`, or end its name in `.npz`"
        raise OutputError("output-kind", "a Parquet table needs the package `pyarrow`", help) from None
    return pyarrow


def write_parquet(path: Path, model: Model, table: Table) -> None:
    """Write a table with columns such as `geom_friction pads/left friction[0]`.

    The schema has the array and index of each column.
    """
    arrow = check_installed()
    fields, columns = [], []
    for name in ("cell", "sample"):
        fields.append(arrow.field(name, arrow.int64()))
        columns.append(getattr(table, name))
    for name, varying in sorted(table.arrays.items()):
        for column, (at, of) in enumerate(zip(varying.index, whose(model, name, varying.index), strict=True)):
            called = " ".join(word for word in (name, of.element, of.attribute) if word)
            place = {_ARRAY: name.encode(), _INDEX: str(at).encode()}
            kind = arrow.from_numpy_dtype(varying.values.dtype)
            fields.append(arrow.field(called, kind, metadata=place))
            columns.append(np.ascontiguousarray(varying.values[:, column]))
    schema = arrow.schema(fields, metadata={_ABOUT: json.dumps(table.about()).encode()})
    arrow.parquet.write_table(arrow.table(columns, schema=schema), path)


def read_parquet(content: bytes) -> Table:
    """Parse a table. Raises ValueError, KeyError, TypeError or OSError for anything else."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise ValueError("a Parquet table needs the package `pyarrow`: `pip install pyarrow`") from None
    found = pyarrow.parquet.read_table(pyarrow.BufferReader(content))
    about = json.loads((found.schema.metadata or {})[_ABOUT])
    numbers: dict[str, tuple[list[int], list[Any]]] = {}
    given: dict[str, Any] = {}
    for each, column in zip(found.schema, found.columns, strict=True):
        place = each.metadata or {}
        if _ARRAY not in place:
            given[each.name] = column.to_numpy()
            continue
        index, values = numbers.setdefault(place[_ARRAY].decode(), ([], []))
        index.append(int(place[_INDEX]))
        values.append(column.to_numpy())
    arrays = {
        name: Varying(np.array(index, np.int64), np.stack(values, axis=1)) for name, (index, values) in numbers.items()
    }  # fmt: skip
    return of_about(about, arrays, cell=given["cell"], sample=given["sample"])
