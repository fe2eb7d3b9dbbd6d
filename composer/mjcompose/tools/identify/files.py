"""Open a recording, a file or a folder, and read it with the reader of its format.

Runs in MuJoCo's process, with its limits of time and memory. The packages for Parquet and MCAP are imported only for
such files.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BufferedReader
from itertools import islice
from pathlib import Path

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import Refused, TooLarge, open_regular
from mjcompose.tools.identify.tables import RecordedTable, RecordingFault, SizeLimits, read_csv, read_npz, too_large

INFO = "meta/info.json"
"""The file that makes a folder a data set of LeRobot."""
_DATA = "data/*/*.parquet"
_BAG = "*.mcap"
_MOST_FILES = 10_000
"""The most files of a folder."""


class RecordedFile(Struct):
    """The contents of a recording: a table, and the commands if they have a clock of their own.

    `advice` says how to read commands, if the file may have some that were not read.
    """

    sha256: str
    table: RecordedTable
    commands: RecordedTable | None = None
    advice: str | None = None

    @property
    def tables(self) -> Iterator[RecordedTable]:
        yield self.table
        if self.commands is not None:
            yield self.commands


class ReadingKeys(Struct):
    """The keys of `recording` for topics, clocks and episodes; `ignores` says whether a name is left out."""

    state: str
    command: str | None
    command_joints: tuple[str, ...]
    clock: str
    episode: int | None
    ignores: Callable[[str], bool]


def read_file(path: Path, keys: ReadingKeys, limits: SizeLimits) -> RecordedFile:
    """Return the contents of a recording. Raises RecordingFault."""
    if os.path.isdir(path):
        return _read_folder(path, keys, limits)
    suffix = path.suffix.lower()
    if suffix == ".mcap":
        from mjcompose.tools.identify.mcap_files import read_mcap

        return read_mcap([path], keys, limits)
    read = _READERS.get(suffix)
    if read is None:
        raise _other_kind(path)
    with opened(path, limits) as (file, digest):
        return RecordedFile(digest, read(file, keys, limits))


def _read_folder(folder: Path, keys: ReadingKeys, limits: SizeLimits) -> RecordedFile:
    if os.path.exists(folder / INFO):
        from mjcompose.tools.identify.lerobot import read_dataset

        return read_dataset(folder, data_files(folder), keys, limits)
    logs = sorted(islice(folder.glob(_BAG), _MOST_FILES), key=_in_order)
    if not logs:
        message = f"it is a folder without `{INFO}` of LeRobot, and without files of MCAP"
        raise RecordingFault("recording-kind", message, "name a file, a data set of LeRobot, or a bag of ROS 2 in MCAP")
    from mjcompose.tools.identify.mcap_files import read_mcap

    return read_mcap(logs, keys, limits)


def data_files(folder: Path) -> list[Path]:
    """Return the files with the numbers of a data set of LeRobot, in their order."""
    return sorted(islice(folder.glob(_DATA), _MOST_FILES))


def files_of(path: Path) -> Iterable[Path]:
    """Return all files that reading a recording may open."""
    if not os.path.isdir(path):
        return [path]
    return [path / INFO, *data_files(path), *islice(path.glob(_BAG), _MOST_FILES)]


def _in_order(path: Path) -> list[tuple[int, str]]:
    """Return the key that sorts the parts of a bag: `run_2` before `run_10`."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", path.name)]


def _other_kind(path: Path) -> RecordingFault:
    known = [f"`{suffix}`" for suffix in (*_READERS, ".mcap")]
    help = f"write the recording as {', '.join(known[:-1])} or {known[-1]}, or name a data set of LeRobot"
    if path.suffix.lower() == ".db3":
        help = "convert the bag to MCAP: `ros2 bag convert`, with `storage_id: mcap`"
    return RecordingFault("recording-kind", f"no recording ends in `{path.suffix}`", help)


@contextmanager
def opened(path: Path, limits: SizeLimits) -> Iterator[tuple[BufferedReader, str]]:
    """Open a file, and compute its SHA-256. Raises RecordingFault."""
    with _open(path, limits) as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        file.seek(0)
        yield file, digest


def _open(path: Path, limits: SizeLimits) -> BufferedReader:
    try:
        return open_regular(path, limits.size)
    except FileNotFoundError:
        raise RecordingFault("file-not-found", "the recording does not exist") from None
    except TooLarge as error:
        raise too_large("bytes", error.size, limits) from None
    except (Refused, IsADirectoryError):
        raise RecordingFault("file-unreadable", "it is not a regular file", "name a file") from None
    except OSError as error:
        raise RecordingFault("file-unreadable", f"it cannot be read: {error.strerror or error}") from None


def together(digests: Sequence[str]) -> str:
    """Return the SHA-256 of a recording in several files; of a single file it is the file's own."""
    if len(digests) == 1:
        return digests[0]
    return hashlib.sha256("".join(digests).encode()).hexdigest()


def not_installed(package: str) -> RecordingFault:
    """Return the fault of a recording whose package is not installed."""
    message = f"it needs the Python package `{package}`, which is not installed"
    return RecordingFault("not-installed", message, 'run `pip install "mjcompose[identify]"`')


@contextmanager
def damaged(kind: str) -> Iterator[None]:
    """Turn any exception of a library into the fault of a file that is not of its `kind`, or damaged."""
    try:
        yield
    except RecordingFault:
        raise
    except MemoryError:
        help = "record fewer columns, or raise the limit: `--limit memory=16G`"
        raise RecordingFault("limit-exceeded", "it needs more memory than is allowed", help) from None
    except Exception as error:  # the libraries raise exceptions of many types for files that somebody else wrote
        reason = (str(error).splitlines() or ["it ends early"])[0][:200]
        message = f"it is not {kind}, or it is damaged: {reason}"
        raise RecordingFault("recording-kind", message) from None


def _csv(file: BufferedReader, keys: ReadingKeys, limits: SizeLimits) -> RecordedTable:
    return read_csv(file, limits)


def _npz(file: BufferedReader, keys: ReadingKeys, limits: SizeLimits) -> RecordedTable:
    return read_npz(file, limits)


def _parquet(file: BufferedReader, keys: ReadingKeys, limits: SizeLimits) -> RecordedTable:
    from mjcompose.tools.identify.parquet import read_parquet

    return read_parquet(file, keys, limits)


_READERS: Mapping[str, Callable[[BufferedReader, ReadingKeys, SizeLimits], RecordedTable]] = {
    ".csv": _csv,
    ".npz": _npz,
    ".parquet": _parquet,
}
"""The readers of tables by the end of a file's name."""
