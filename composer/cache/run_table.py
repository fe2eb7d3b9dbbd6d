"""A table with a row for each model of a run, as CSV or Parquet: its draws, or the index of all models."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import IO, Any

from composer.bundle.output_error import OutputError
from composer.bundle.place import Place
from composer.bundle.rows import write_rows
from composer.bundle.staging import staged_file
from composer.expr.value import Value
from composer.scratch import scratch

_BATCH = 1000


class RunTable:
    """Keeps rows in a temporary file until all columns are known, so that memory use stays constant.

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

    def write(self, path: Place, option: str | None = None) -> None:
        """Write all rows, as Parquet if the name says so, completely or not at all. Raises OutputError."""
        if not isinstance(path, Path):
            from composer.bundle.remote import deliver_file

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
            for rows in _batches(self._read()):
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


def _batches(rows: Iterator[list[Any]]) -> Iterator[list[list[Any]]]:
    batch: list[list[Any]] = []
    for row in rows:
        batch.append(row)
        if len(batch) == _BATCH:
            yield batch
            batch = []
    if batch:
        yield batch
