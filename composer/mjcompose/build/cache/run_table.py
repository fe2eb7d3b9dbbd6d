"""A table with a row for each model of a run."""

from __future__ import annotations

import itertools
import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import IO, Any

from mjcompose.base.scratch import scratch
from mjcompose.build.bundle.bundle import Location, OutputError
from mjcompose.build.bundle.listing import SIZES, column, write_rows
from mjcompose.build.bundle.staging import staged_file
from mjcompose.build.cache.builder import BuildResult
from mjcompose.language.expand import Cell
from mjcompose.text.expression import Value

Row = tuple[list[Value | None], dict[str, Value]]


def index_row(cell: Cell, result: BuildResult, path: str, checks: int) -> Row:
    """Return the values of the columns that every model has (`bundle/listing.py`), and the other columns by name.

    The latter are the values of the matrix and of draws, with one column for each number of a vector.
    """
    sizes = result.sizes or {}
    sample = cell.sample if cell.is_sample else None
    about = [cell.name, cell.cell, sample, path.replace(os.sep, "/"), result.sha256, result.mujoco, checks]
    given = {name: value for name, value in cell.values().items() if value is not None}
    found: dict[str, Value] = {}
    for name, value in {**given, **(result.draws or {})}.items():
        if isinstance(value, tuple):
            found |= {f"{column(name)}[{number}]": each for number, each in enumerate(value)}
        else:
            found[column(name)] = value
    return [*about, *(sizes.get(name) for name in SIZES)], found


_BATCH = 1000


class RunTable:
    """Keeps rows in a temporary file until all columns are known, so memory use stays constant.

    `first` are the columns that every row has, with their types. Missing values are empty.
    """

    def __init__(self, first: Mapping[str, type]) -> None:
        self._first = dict(first)
        self._rows: IO[str] = tempfile.TemporaryFile("w+", encoding="utf-8")  # noqa: SIM115  (closed by `close`)
        self._columns: dict[str, type] = {}
        self.count = 0

    def add(self, first: Sequence[Value | None], row: Mapping[str, Value]) -> None:
        """Add a row: the values of the first columns, and the others by column."""
        for name, value in row.items():
            if self._columns.setdefault(name, _kind(value)) is not _kind(value):
                self._columns[name] = str
        self._rows.write(json.dumps([*first, dict(row)]) + "\n")
        self.count += 1

    def write(self, path: Location, option: str | None = None) -> None:
        """Write all rows, as Parquet if the name says so, completely or not at all. Raises OutputError."""
        if not isinstance(path, Path):
            from mjcompose.build.bundle.remote import deliver_file

            with scratch("table") as folder:
                table = folder / PurePosixPath(path).name
                self.write(table)
                deliver_file(table, path)
            return
        columns = [*self._first, *self._columns]
        with staged_file(path, option) as stage:
            if path.suffix.lower() == ".parquet":
                self._write_parquet(stage, columns)
            else:
                with stage.open("w", encoding="utf-8", newline="") as file:
                    write_rows(file, columns, self._read())

    def close(self) -> None:
        """Delete the rows."""
        self._rows.close()

    def _read(self) -> Iterator[list[Any]]:
        self._rows.seek(0)
        for line in self._rows:
            *first, row = json.loads(line)
            yield [*first, *(row.get(name) for name in self._columns)]

    def _write_parquet(self, stage: Path, columns: Sequence[str]) -> None:
        check_parquet()
        import pyarrow
        from pyarrow import parquet

        types = {str: pyarrow.string(), float: pyarrow.float64()}
        kinds: list[type] = [*self._first.values(), *self._columns.values()]
        schema = pyarrow.schema(
            [(name, types.get(kind, pyarrow.int64())) for name, kind in zip(columns, kinds, strict=True)]
        )
        with parquet.ParquetWriter(stage, schema) as writer:
            rest = self._read()
            while rows := list(itertools.islice(rest, _BATCH)):
                filled = [
                    [None if each is None else kind(each) for each in column]
                    for kind, column in zip(kinds, zip(*rows, strict=True), strict=True)
                ]
                writer.write_table(pyarrow.table(filled, schema=schema))


def check_parquet() -> None:
    """Raise OutputError if Parquet cannot be written."""
    if find_spec("pyarrow") is None:
        help = 'run `pip install "mjcompose[parquet]"`, or write a `.csv`'
        raise OutputError("output-kind", "a Parquet table needs the package `pyarrow`", help)


def _kind(value: Value) -> type:
    return str if isinstance(value, str | bool) else int if isinstance(value, int) else float
