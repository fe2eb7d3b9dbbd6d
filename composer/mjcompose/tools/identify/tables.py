"""The columns of a recording, read from CSV and NPZ. Runs in MuJoCo's process, with its limits of time and memory."""

from __future__ import annotations

import csv
import io
import zipfile
import zlib
from collections.abc import Mapping
from io import BufferedReader, TextIOWrapper
from typing import Any

import numpy as np
import numpy.typing as npt

from mjcompose.base.dataclass import Struct
from mjcompose.base.limits import written

Series = npt.NDArray[np.float64]
CLOCKS = ("time", "t", "timestamp")
"""Names of the column with the time."""
_CODE = "recording-column"
_HEADER = 1 << 14
"""The most bytes of a header that are read: numpy refuses longer ones, after it has read them."""
_NOT_NPZ = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    OSError,
    NotImplementedError,
    RuntimeError,
    ValueError,
)
"""Exceptions of `zipfile` and numpy for broken files."""


class RecordingFault(Exception):
    """A recording that cannot be used; `line` is the line of a text file, and `field` a field of `identify`.

    `at` is the path of a key of `identify` that is wrong.
    """

    def __init__(
        self,
        code: str,
        message: str,
        help: str | None = None,
        *,
        line: int | None = None,
        field: str | None = None,
        at: tuple[str, ...] = (),
    ) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.help = help
        self.line = line
        self.field = field
        self.at = at
        self.file: str | None = None


class RecordedTable(Struct):
    """The columns of a file by name, and the time of each row, in the unit of the file. `lines` are lines of text.

    If it is `timed`, its times are in seconds. If it is `sparse`, a row may have numbers for some columns alone.
    """

    times: Series
    columns: Mapping[str, Series]
    lines: npt.NDArray[np.int64] | None = None
    timed: bool = False
    sparse: bool = False

    def line(self, row: int) -> int | None:
        return None if self.lines is None else int(self.lines[row])

    @property
    def header(self) -> int | None:
        """The line with the names of the columns, None for a file without lines."""
        return None if self.lines is None else 1


class SizeLimits(Struct):
    """The most bytes of a file, also unpacked, and the most numbers in it."""

    size: int
    numbers: int


def too_large(what: str, count: int, limits: SizeLimits) -> RecordingFault:
    """Return the fault of a file with too many `bytes` or `numbers`."""
    name, most = ("recording-size", limits.size) if what == "bytes" else ("recording-numbers", limits.numbers)
    help = f"cut the recording into several, or record fewer columns; `--limit {name}={written(name, count)}` allows it"
    return RecordingFault("limit-exceeded", f"it has {count} {what}; {most} are allowed", help)


def check_count(count: int, limits: SizeLimits) -> None:
    """Refuse more numbers than the limits allow."""
    if count > limits.numbers:
        raise too_large("numbers", count, limits)


def with_clock(columns: dict[str, Series], lines: npt.NDArray[np.int64] | None = None) -> RecordedTable:
    """Return the table of columns, one of which has the time. Raises RecordingFault."""
    clock = next((name for name in CLOCKS if name in columns), None)
    if clock is None:
        help = "name the column with the time in seconds `time`"
        raise RecordingFault(_CODE, "it has no column `time`", help)
    times = columns.pop(clock)
    if len(times) < 2:
        raise RecordingFault("recording-time", f"it has {len(times)} rows", "record some seconds of motion")
    return RecordedTable(times, columns, lines)


def read_csv(file: BufferedReader, limits: SizeLimits) -> RecordedTable:
    """Read a text of numbers, with the names of the columns in its first row."""
    rows: list[list[float]] = []
    lines: list[int] = []
    with TextIOWrapper(file, newline="", encoding="utf-8-sig") as text:
        reader = csv.reader(text)
        try:
            header = [name.strip() for name in next(reader, [])]
            _check_header(header)
            for row in reader:
                if not row:
                    continue
                rows.append(_numbers(row, header, reader.line_num))
                lines.append(reader.line_num)
                check_count(len(rows) * len(header), limits)
        except UnicodeDecodeError:
            raise RecordingFault("recording-kind", "it is not text in UTF-8", "save it as UTF-8") from None
        except csv.Error as error:
            raise RecordingFault("csv-syntax", f"it is not CSV: {error}", line=reader.line_num) from None
    table = np.array(rows, float).reshape(len(rows), len(header))
    return with_clock(dict(zip(header, table.T.copy(), strict=True)), np.array(lines, np.int64))


def _check_header(header: list[str]) -> None:
    if not header:
        raise RecordingFault(_CODE, "it is empty", "its first row has the names of the columns")
    if len(header) == 1 and any(separator in header[0] for separator in ";\t"):
        raise RecordingFault(_CODE, "its columns are not separated by commas", "write `,` between them", line=1)
    seen: set[str] = set()
    for name in header:
        check_new(name, seen, line=1)


def check_new(name: str, seen: set[str], line: int | None = None) -> None:
    """Refuse a column that is there already."""
    if name in seen:
        raise RecordingFault(_CODE, f"it has two columns `{name}`", "remove one of them", line=line)
    seen.add(name)


def _numbers(row: list[str], header: list[str], line: int) -> list[float]:
    if len(row) != len(header):
        message = f"it has {len(row)} values in a row, and {len(header)} columns"
        raise RecordingFault("recording-value", message, "is the row cut off? remove it", line=line)
    try:
        if not all(map(_is_plain, row)):
            raise ValueError
        return [float(value) if value.strip() else np.nan for value in row]
    except ValueError:
        for name, value in zip(header, row, strict=True):
            if value.strip() and not _is_number(value):
                message = f"`{name}` is `{value.strip()[:40]}`, which is not a number"
                raise RecordingFault("recording-value", message, line=line) from None
        raise


def _is_plain(text: str) -> bool:
    """Return whether a text has no underscores and no digits of other scripts, which Python would read as numbers."""
    return "_" not in text and text.isascii()


def _is_number(text: str) -> bool:
    if not _is_plain(text):
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_npz(file: BufferedReader, limits: SizeLimits) -> RecordedTable:
    """Read the arrays of an NPZ without pickles. The headers say how large they are before they are unpacked."""
    columns: dict[str, Series] = {}
    seen: set[str] = set()
    total = 0
    try:
        with zipfile.ZipFile(file) as archive:
            for entry in archive.infolist():
                if not entry.filename.endswith(".npy"):
                    continue
                shape, dtype = _npy_header(archive, entry)
                name = entry.filename.removesuffix(".npy")
                check_new(name, seen)
                if dtype.hasobject or dtype.kind not in "fiub":
                    message = f"`{name}` has values of the type {dtype}, not numbers"
                    raise RecordingFault("recording-value", message, "store arrays of floats")
                if len(shape) != 1:
                    help = "store one array for each joint: `qpos NAME`"
                    raise RecordingFault(_CODE, f"`{name}` has {len(shape)} dimensions, not 1", help)
                total += shape[0]
                check_count(total, limits)
                with archive.open(entry) as array:
                    columns[name] = np.lib.format.read_array(array, allow_pickle=False).astype(float)
    except _NOT_NPZ as error:
        raise RecordingFault("recording-kind", f"it is not an NPZ file: {error}") from None
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) > 1:
        shortest = min(lengths, key=lengths.__getitem__)
        longest = max(lengths, key=lengths.__getitem__)
        message = f"`{shortest}` has {lengths[shortest]} values, and `{longest}` has {lengths[longest]}"
        raise RecordingFault("recording-value", message, "store arrays of one length, with the same times")
    return with_clock(columns)


def _npy_header(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> tuple[tuple[int, ...], np.dtype[Any]]:
    with archive.open(entry) as file:
        header = io.BytesIO(file.read(_HEADER))
    version = np.lib.format.read_magic(header)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read(header)
    return shape, dtype
