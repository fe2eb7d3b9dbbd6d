"""Read recordings in Parquet: numbers by column, in pieces, within the limits. Runs in MuJoCo's process."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import BufferedReader
from typing import Any

import numpy as np

from mjcompose.tools.identify.files import ReadingKeys, damaged, not_installed
from mjcompose.tools.identify.tables import (
    CLOCKS,
    RecordedTable,
    RecordingFault,
    Series,
    SizeLimits,
    check_count,
    check_new,
    with_clock,
)

_KIND = "a Parquet file"
_ROWS = 1 << 16
"""Rows that are unpacked at once."""
_SAFE = (14, 0, 1)
"""The version from which pyarrow runs no code of a file (CVE-2023-47248)."""
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def arrow() -> Any:
    """Return pyarrow, with its modules `compute` and `parquet`. Raises RecordingFault without a safe version."""
    try:
        import pyarrow
        import pyarrow.compute
        import pyarrow.parquet
    except ImportError:
        raise not_installed("pyarrow") from None
    version = tuple(int(part) for part in pyarrow.__version__.split(".")[:3] if part.isdigit())
    if version < _SAFE:
        message = f"pyarrow {pyarrow.__version__} is too old: it can run code of a file"
        raise RecordingFault("not-installed", message, 'run `pip install --upgrade "mjcompose[identify]"`')
    return pyarrow


def read_parquet(file: BufferedReader, keys: ReadingKeys, limits: SizeLimits) -> RecordedTable:
    """Return the columns of numbers of a file. Raises RecordingFault."""
    pyarrow = arrow()
    with damaged(_KIND):
        contents = pyarrow.parquet.ParquetFile(file)
        names = _columns_of_numbers(pyarrow, contents.schema_arrow, keys)
        check_count(contents.metadata.num_rows * len(names), limits)
        parts: dict[str, list[Any]] = {name: [] for name in names}
        for batch in batches(contents, names, limits):
            for name in names:
                parts[name].append(batch.column(name))
        columns = {
            name: pyarrow.chunked_array(arrays, contents.schema_arrow.field(name).type)
            for name, arrays in parts.items()
        }
        return _table(pyarrow, columns)


def _columns_of_numbers(pyarrow: Any, schema: Any, keys: ReadingKeys) -> list[str]:
    """Return the names of the columns to read; columns of another type must be ignored."""
    seen: set[str] = set()
    names = []
    for field in schema:
        check_new(field.name, seen)
        if _is_number(pyarrow, field.type) or (field.name in CLOCKS and _unit(pyarrow, field.type)):
            names.append(field.name)
        elif not keys.ignores(field.name):
            raise _no_numbers(pyarrow, field)
    return names


def _no_numbers(pyarrow: Any, field: Any) -> RecordingFault:
    if field.name in ("observation.state", "action"):
        help = "to read a data set of LeRobot, name its folder"
    elif pyarrow.types.is_nested(field.type):
        help = "store one column for each joint: `qpos NAME`"
    else:
        help = f"store numbers, or leave the column out: `recording: {{ignore: [{field.name}]}}`"
    return RecordingFault("recording-value", f"`{field.name}` has values of the type {field.type}, not numbers", help)


def _is_number(pyarrow: Any, kind: Any) -> bool:
    types = pyarrow.types
    return bool(types.is_floating(kind) or types.is_integer(kind) or types.is_boolean(kind) or types.is_decimal(kind))


def _unit(pyarrow: Any, kind: Any) -> str | None:
    """Return the unit of a type of times, or None for another type."""
    is_time = pyarrow.types.is_timestamp(kind) or pyarrow.types.is_duration(kind)
    return str(kind.unit) if is_time else None


def batches(
    contents: Any, names: Sequence[str], limits: SizeLimits, groups: Sequence[int] | None = None
) -> Iterator[Any]:
    """Yield the rows of columns in pieces. Raises RecordingFault for more numbers than the limits allow."""
    count = 0
    for batch in contents.iter_batches(_ROWS, row_groups=groups, columns=list(names), use_threads=False):
        count += batch.num_rows * len(names)
        check_count(count, limits)
        yield batch


def floats(pyarrow: Any, column: Any) -> Series:
    """Return the numbers of a column; a missing one is NaN."""
    kind = column.type
    if pyarrow.types.is_decimal(kind):
        column = column.cast(pyarrow.float64())
    elif pyarrow.types.is_boolean(kind):
        column = column.cast(pyarrow.int8())
    values: Series = np.asarray(column.to_numpy(), float)
    return values


def _table(pyarrow: Any, columns: dict[str, Any]) -> RecordedTable:
    clock = next((name for name in CLOCKS if name in columns), None)
    unit = None if clock is None else _unit(pyarrow, columns[clock].type)
    numbers = {
        name: _times(pyarrow, column) if name == clock else floats(pyarrow, column) for name, column in columns.items()
    }
    table = with_clock(numbers)
    return RecordedTable(table.times, table.columns, timed=unit is not None)


def _times(pyarrow: Any, column: Any) -> Series:
    """Return times as floats: whole numbers, such as nanoseconds since 1970, are counted from the first."""
    unit = _unit(pyarrow, column.type)
    is_whole = unit is not None or pyarrow.types.is_integer(column.type)
    if not is_whole or column.null_count or not len(column):
        if column.null_count and unit is not None:
            raise RecordingFault("recording-time", "a row has no time", "remove it")
        return floats(pyarrow, column)
    whole = column.cast(pyarrow.int64()).to_numpy()
    seconds = 1.0 if unit is None else _SECONDS[unit]
    times: Series = (whole - whole[0]) * seconds
    return times
