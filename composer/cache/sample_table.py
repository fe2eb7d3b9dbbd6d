"""The table of all that was drawn: a row for each model, a column for each number, as CSV or Parquet."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

from composer.bundle.output_error import OutputError
from composer.bundle.rows import write_rows
from composer.bundle.staging import staged_file
from composer.expr.value import Value

FILE = "samples.csv"
_FIRST = ("model", "sample")
_BATCH = 1000


class SampleTable:
    """Rows are kept in a temporary file until all columns are known, so that memory does not grow with them.

    Sample 0 has no draws: its cells are empty, as are those of what a model does not have.
    """

    def __init__(self) -> None:
        self._rows: IO[str] = tempfile.TemporaryFile("w+", encoding="utf-8")  # noqa: SIM115  (closed by `close`)
        self._columns: dict[str, type] = {}
        self.count = 0

    def add(self, model: str, sample: int, row: Mapping[str, Value]) -> None:
        """The row of a model: its numbers by their columns."""
        for name, value in row.items():
            if self._columns.setdefault(name, _kind(value)) is not _kind(value):
                self._columns[name] = str
        self._rows.write(json.dumps([model, sample, dict(row)]) + "\n")
        self.count += 1

    def write(self, path: Path) -> None:
        """Write all rows, as Parquet where the name ends so. Raises OutputError; either whole or not at all."""
        columns = [*_FIRST, *self._columns]
        with staged_file(path) as stage:
            if path.suffix.lower() == ".parquet":
                self._write_parquet(stage, columns)
            else:
                with stage.open("w", encoding="utf-8", newline="") as file:
                    write_rows(file, columns, self._read())

    def close(self) -> None:
        """Let go of the rows."""
        self._rows.close()

    def _read(self) -> Iterator[list[Any]]:
        self._rows.seek(0)
        for line in self._rows:
            model, sample, row = json.loads(line)
            yield [model, sample, *(row.get(name) for name in self._columns)]

    def _write_parquet(self, stage: Path, columns: Sequence[str]) -> None:
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            help = "`pip install pyarrow`, or end its name in `.csv`"
            raise OutputError("output-kind", "a Parquet table needs the package `pyarrow`", help) from None
        types = {str: pyarrow.string(), float: pyarrow.float64()}
        kinds: list[type] = [str, int, *self._columns.values()]
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
