"""The table of all models in a folder, and conditions on its rows.

A spreadsheet runs a text that begins with `=` as a formula. Such a text may come from somebody else's recipe, so it is
written after a `'`. A text that begins with `'` is written in the same way. Numbers stay as they are.
"""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from io import TextIOWrapper
from pathlib import Path, PurePosixPath
from typing import IO, Any, TextIO, TypeVar

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import DiagnosticError, Note
from mjcompose.base.files import TooLarge, open_regular
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.bundle.bundle import Location
from mjcompose.text.evaluate import Inserted, names
from mjcompose.text.expression import CONSTANTS, FUNCTIONS, ExpressionError, Value, kind as value_kind, parse

_FORMULA = tuple("=+-@\t\r\n＝＋－＠'")


def write_rows(file: TextIO, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a header and rows. Numbers are as short as they can be read back exactly; None is empty."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(map(escape_formula, columns))
    for row in rows:
        writer.writerow([_text(each) for each in row])


def escape_formula(text: str) -> str:
    """Return a text in the form for a table, which no spreadsheet runs as a formula.

    >>> escape_formula("=1+1"), escape_formula("arm"), escape_formula("'arm'"), escape_formula("-0.5")
    ("'=1+1", 'arm', "''arm'", '-0.5')
    """
    return f"'{text}" if text.startswith(_FORMULA) and not _is_number(text) else text


def unescape_formula(text: str) -> str:
    """Return the original of a text in a table.

    >>> all(unescape_formula(escape_formula(each)) == each for each in ("=1+1", "arm", "'arm'", "''", "-0.5", ""))
    True
    """
    return text.removeprefix("'")


def _is_number(text: str) -> bool:
    with suppress(ValueError):
        float(text)
        return text.isascii() and text == text.strip()
    return False


def _text(value: Any) -> Any:
    if isinstance(value, bool):
        return str(value).lower()
    return "" if value is None else escape_formula(value) if isinstance(value, str) else value


MODELS = "models.csv"
_PART = re.compile(r"models-\d+-of-\d+\.\w+")
_BATCH = 1000
Item = TypeVar("Item")
SIZES = ("nq", "nv", "nu", "nbody", "njnt", "ngeom", "nsensor", "nkey")
COLUMNS: Mapping[str, type] = {
    "model": str,
    "cell": str,
    "sample": int,
    "path": str,
    "sha256": str,
    "mujoco": str,
    "checks": int,
    **dict.fromkeys(SIZES, int),
}
"""The columns of every model, followed by the columns of the matrix and of draws."""


class ListingError(DiagnosticError):
    """There is no index, or the file is not an index."""


class IndexRow(Struct):
    """One model of an index: `file` is its bundle, and `values` are the non-empty values by column."""

    file: Location
    values: Mapping[str, Value]


def column(name: str) -> str:
    """Return the column for a value.

    >>> column("payload"), column("path")
    ('payload', 'value path')
    """
    return f"value {name}" if name in COLUMNS else name


def rows(path: Location, shown: str) -> Iterator[IndexRow]:
    """Yield the models of an index: a folder, an address, one of its parts, or itself. Raises ListingError."""
    if isinstance(path, str):
        yield from _rows_at(path, shown)
        return
    if not os.path.exists(path):
        raise ListingError("file-not-found", f"`{shown}` does not exist")
    files = [path]
    if os.path.isdir(path):
        files = _indexes({each.name: each for each in path.iterdir() if each.name.startswith("models")}, shown)
    for file in files:
        with _readable(str(file)), open_regular(file) as stream:
            yield from _rows(stream, str(file), file.parent)


def _rows_at(address: str, shown: str) -> Iterator[IndexRow]:
    from mjcompose.bundle.remote import RemoteError, open_remote

    try:
        with open_remote(address) as (fs, path):
            files = [path]
            if not fs.isfile(path):
                files = _indexes({each.rpartition("/")[2]: each for each in fs.ls(path, False)}, shown)
            for file in files:
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
        reason = getattr(error, "strerror", None) or "it is not a table of models"
        if isinstance(error, TooLarge):
            reason = str(error)
        raise ListingError("file-unreadable", f"`{file}` cannot be read: {reason}") from error


def _rows(stream: IO[bytes], file: str, folder: Location) -> Iterator[IndexRow]:
    for number, each in enumerate(_records(stream, file), 1):
        inside = PurePosixPath(each["path"])
        if not each["path"] or inside.is_absolute() or ".." in inside.parts:
            message = f"row {number} of `{file}` names no model below its folder: `{each['path']}`"
            raise ListingError("source-outside", message)
        values = {name: _value(name, text) for name, text in each.items() if text is not None and text != ""}
        yield IndexRow(folder / inside if isinstance(folder, Path) else f"{folder}/{inside}", values)


def _records(stream: IO[bytes], file: str) -> Iterator[Mapping[str, Any]]:
    """Yield the rows of a table by column; in CSV all values are text."""
    if file.lower().endswith(".parquet"):
        columns, records = _of_parquet(stream, file)
    else:
        reader = csv.DictReader(TextIOWrapper(stream, "utf-8", newline=""), strict=True)
        reader.fieldnames = columns = list(map(unescape_formula, reader.fieldnames or ()))
        records = (
            {name: unescape_formula(text) if isinstance(text, str) else text for name, text in each.items()}
            for each in reader
        )
    if "path" not in columns:
        raise ListingError("wrong-type", f"`{file}` does not list models: it has no column `path`")
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
    return table.schema_arrow.names, (row for batch in table.iter_batches(_BATCH) for row in batch.to_pylist())


def _indexes(names: Mapping[str, Item], shown: str) -> list[Item]:
    """Return the index of a folder and its parts: CSV, or Parquet if there is no CSV."""
    for form in (".csv", ".parquet"):
        parts = (name for name in names if _PART.fullmatch(name) and name.endswith(form))
        in_order = sorted(parts, key=lambda name: (len(name), name))
        found = [names[name] for name in (f"models{form}", *in_order) if name in names]
        if found:
            return found
    help = "run `mjcompose build RECIPE --all -o 'FOLDER/{name}/'`, which writes it"
    raise ListingError("file-not-found", f"`{shown}` has no index of models, `{MODELS}`", help)


def _value(name: str, text: Any) -> Value:
    """Convert a text of the table by the type of its column, or by its own form if not every model has the column."""
    if not isinstance(text, str) or COLUMNS.get(name) is str:  # Parquet has types
        return text  # type: ignore[no-any-return]
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text


T = TypeVar("T")


def with_fields(values: Mapping[str, T]) -> dict[str, T]:
    """Return the values of a row, and also each drawn field with a single column by its plain name.

    >>> with_fields({"sample": 1, "friction[cube]": 0.5, "mass[a]": 2, "mass[b]": 3})["friction"]
    0.5
    """
    columns: dict[str, list[str]] = {}
    for column in values:
        name, bracket, _ = column.partition("[")
        if bracket:
            columns.setdefault(name, []).append(column)
    alone = {name: values[found[0]] for name, found in columns.items() if len(found) == 1}
    return {**alone, **values}


class RowCondition:
    """A condition for all rows of an index. Raises ListingError if it is not a valid expression.

    A model without a value for a name does not match, for example if its cell does not set it; `lacking` counts such
    models by name. A name that no model has is an error, which `check` raises.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        try:
            self._expression = Inserted(0, text, parse(text))
        except ExpressionError as error:
            raise self._fault(error) from error
        self._names = {each.name for each in names(self._expression.tree)} - {*CONSTANTS, *FUNCTIONS}
        self._known: dict[str, None] = {}
        self.lacking: dict[str, int] = {}
        self.count = 0

    def holds(self, row: IndexRow) -> bool:
        """Return whether a model matches. Raises ListingError."""
        self.count += 1
        self._known.update(dict.fromkeys(row.values))
        values = with_fields(row.values)
        absent = sorted(self._names - values.keys())
        if absent:
            for name in absent:
                self.lacking[name] = self.lacking.get(name, 0) + 1
            return False
        try:
            value = self._expression.value(values)
        except ExpressionError as error:
            raise self._fault(error) from error
        if not isinstance(value, bool):
            raise ListingError(
                "expression",
                f"`{self.text}` is {value_kind(value)}, and not true or false",
                "write for instance `payload > 2`",
            )
        return value

    def check(self) -> None:
        """Raise an error for a name that no model has. Call it after the last row."""
        for name, count in self.lacking.items():
            if count == self.count:
                words = [each for each in self._known if each.isidentifier()]
                several = [each for each in self._known if each.startswith(f"{name}[")]
                note = Note(f"drawn for several: {', '.join(several[:3])}")
                notes = (note if several else exists_note("column", words, name),)
                message = f"no model has a column `{name}`"
                raise ListingError("unknown-name", message, did_you_mean(name, words), notes=notes)

    def _fault(self, error: ExpressionError) -> ListingError:
        return ListingError("expression", f"`{self.text}`, character {error.at[0] + 1}: {error.message}", error.help)
