"""Read the index that `build --all` writes of all models in a folder, `models.csv` or `models.parquet`."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path, PurePosixPath
from typing import IO, Any, TypeVar

from composer.bundle.place import Place
from composer.bundle.rows import unguarded
from composer.dataclass import dataclass
from composer.diagnostics.error import DiagnosticError
from composer.expr.value import Value
from composer.reading.regular import TooLarge, open_regular

MODELS = "models.csv"
_PART = re.compile(r"models-\d+-of-\d+\.\w+")
_BATCH = 1000
Item = TypeVar("Item")
_FORMS = (".csv", ".parquet")
SIZES = ("nq", "nv", "nu", "nbody", "njnt", "ngeom", "nsensor", "nkey")
COLUMNS: Mapping[str, type] = {
    "model": str, "cell": str, "sample": int, "path": str, "sha256": str, "mujoco": str, "checks": int,
    **dict.fromkeys(SIZES, int),
}  # fmt: skip
"""The columns of every model, followed by those of the matrix and of draws."""


class ListingError(DiagnosticError):
    """There is no index, or the file is not an index."""


@dataclass(frozen=True, slots=True)
class Row:
    """One model of an index: `file` is its bundle, `values` are the non-empty values by column."""

    file: Place
    values: Mapping[str, Value]


def column(name: str) -> str:
    """Return the column for a value.

    >>> column("payload"), column("path")
    ('payload', 'value path')
    """
    return f"value {name}" if name in COLUMNS else name


def rows(path: Place, shown: str) -> Iterator[Row]:
    """Yield the models of an index, given as a folder, one of its parts, or the index itself. Raises ListingError.

    A folder or an index may be at an address.
    """
    if isinstance(path, str):
        yield from _rows_at(path, shown)
        return
    for file in _files(path, shown):
        with _readable(str(file)), open_regular(file) as stream:
            yield from _rows(stream, str(file), file.parent)


def _rows_at(address: str, shown: str) -> Iterator[Row]:
    from composer.bundle.remote import RemoteError, opened

    try:
        with opened(address) as (fs, path):
            found = (
                [path]
                if fs.isfile(path)
                else _indexes({each.rpartition("/")[2]: each for each in fs.ls(path, False)})
            )
            if not found:
                raise _none(shown)
            for file in found:
                folder = address.rstrip("/") if file != path else address.rpartition("/")[0]
                with _readable(f"{folder}/{file.rpartition('/')[2]}"), fs.open(file) as stream:
                    yield from _rows(stream, file, folder)
    except RemoteError as error:
        raise ListingError("file-unreadable", f"`{shown}` cannot be read: {error}") from error


@contextmanager
def _readable(file: str) -> Iterator[None]:
    try:
        yield
    except (OSError, UnicodeError, csv.Error, TypeError, AttributeError) as error:
        reason = getattr(error, "strerror", None) or "it is no such table"
        if isinstance(error, TooLarge):
            reason = str(error)
        raise ListingError("file-unreadable", f"`{file}` cannot be read: {reason}") from error


def _rows(stream: IO[bytes], file: str, folder: Place) -> Iterator[Row]:
    for number, each in enumerate(_records(stream, file), 1):
        inside = PurePosixPath(each["path"])
        if not each["path"] or inside.is_absolute() or ".." in inside.parts:
            message = f"row {number} of `{file}` names no model below its folder: `{each['path']}`"
            raise ListingError("source-outside", message)
        values = {name: _value(name, text) for name, text in each.items() if text is not None and text != ""}
        yield Row(folder / inside if isinstance(folder, Path) else f"{folder}/{inside}", values)


def _records(stream: IO[bytes], file: str) -> Iterator[Mapping[str, Any]]:
    """Yield the rows of a table by column; in CSV all values are text."""
    if file.lower().endswith(".parquet"):
        columns, records = _of_parquet(stream, file)
    else:
        reader = csv.DictReader(TextIOWrapper(stream, "utf-8", newline=""), strict=True)
        reader.fieldnames = columns = list(map(unguarded, reader.fieldnames or ()))
        records = (
            {name: unguarded(text) if isinstance(text, str) else text for name, text in each.items()}
            for each in reader
        )
    if "path" not in columns:
        raise ListingError("wrong-type", f"`{file}` is no index of models: it has no column `path`")
    yield from records


def _of_parquet(stream: IO[bytes], file: str) -> tuple[Sequence[str], Iterator[Mapping[str, Any]]]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        message = f"`{file}` needs the package `pyarrow`, which is not installed"
        raise ListingError("file-unreadable", message, 'run `pip install "mjcompose[parquet]"`') from None
    try:
        table = parquet.ParquetFile(stream)
    except pyarrow.ArrowInvalid as error:
        raise ListingError("file-unreadable", f"`{file}` cannot be read: {error}") from error
    return table.schema_arrow.names, (
        row for batch in table.iter_batches(_BATCH) for row in batch.to_pylist()
    )


def _files(path: Path, shown: str) -> list[Path]:
    if not os.path.isdir(path):
        if not os.path.exists(path):
            raise ListingError("file-not-found", f"`{shown}` does not exist")
        return [path]
    found = _indexes({each.name: each for each in path.iterdir() if each.name.startswith("models")})
    if not found:
        raise _none(shown)
    return found


def _indexes(names: Mapping[str, Item]) -> list[Item]:
    """Return the index of a folder and its parts: CSV, or Parquet if there is no CSV."""
    for form in _FORMS:
        parts = sorted(
            (name for name in names if _PART.fullmatch(name) and name.endswith(form)), key=_in_order
        )
        if found := [names[name] for name in (f"models{form}", *parts) if name in names]:
            return found
    return []


def _in_order(name: str) -> tuple[int, str]:
    return len(name), name


def _none(shown: str) -> ListingError:
    help = "`mjcompose build RECIPE --all -o 'FOLDER/{name}/'` writes one"
    return ListingError("file-not-found", f"`{shown}` has no index of models, `{MODELS}`", help)


def _value(name: str, text: Any) -> Value:
    """Convert a text of the table: by the type of a column that every model has, else by its form."""
    if not isinstance(text, str):
        return text  # type: ignore[no-any-return]  # of Parquet, which has types
    if COLUMNS.get(name) is str:
        return text
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
