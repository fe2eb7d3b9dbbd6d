"""Single-file entries of the store, such as compressed assets: written in one step, verified when read.

    asked/, built/, raw/, packed/     what the build cache keeps (`composer/cache/cache.py`)
    shapes/                           what was made of meshes (`composer/compose/shape_store.py`)
    writing/                          files being written; they move to their place in one step

No lock is needed: all writers of a key write the same content, or content that is as good.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.reading.regular import open_regular
from composer.sources.lease import lock_file

if TYPE_CHECKING:
    from io import FileIO
    from os import PathLike

KINDS = ("asked", "built", "raw", "packed", "shapes")
WRITING = "writing"
_DIGEST = 32


def key_of(data: object) -> str:
    """Return a key for JSON data. No I/O."""
    return hashlib.sha256(json.dumps(data, ensure_ascii=True).encode()).hexdigest()


def digest(content: bytes) -> str:
    """The sha256 of bytes. No I/O."""
    return hashlib.sha256(content).hexdigest()


def get(store: str | PathLike[str], kind: str, key: str) -> bytes | None:
    """Return an entry and mark it as used now, or None if it does not exist.

    A damaged entry is removed and gives None.
    """
    path = os.path.join(store, kind, key)
    try:
        content = read(path)
    except OSError:
        return None
    with contextlib.suppress(OSError):  # the store of another user may be read-only
        if content is None:
            os.unlink(path)
        else:
            os.utime(path)
    return content


def put(store: str | PathLike[str], kind: str, key: str, content: bytes) -> None:
    """Write an entry completely or not at all. Raises OSError."""
    write_whole(store, os.path.join(store, kind, key), hashlib.sha256(content).digest(), content)


def write_whole(store: str | PathLike[str], path: str | PathLike[str], *pieces: bytes) -> None:
    """Write a file of the store completely or not at all. Raises OSError.

    It is locked while it is written: an unlocked one was left behind by a killed process.
    """
    stage = os.path.join(store, WRITING, f"{os.path.basename(path)}.{os.urandom(6).hex()}")
    try:
        for file in (stage, path):
            os.makedirs(os.path.dirname(file), exist_ok=True)
        with open(stage, "xb", buffering=0) as stream:
            with contextlib.suppress(
                OSError
            ):  # on a file system without locks, leftovers are removed after a time
                lock_file(stream.fileno(), wait=False)
            for piece in pieces:
                _write_all(stream, piece)
            if os.name == "posix":  # other systems cannot rename an open file
                os.replace(stage, path)
        if os.name != "posix":
            os.replace(stage, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(stage)
        raise


def is_left(stage: str | PathLike[str]) -> bool:
    """Return whether a staged file was left by a killed process. An empty one may not be locked yet."""
    try:
        file = os.open(stage, os.O_RDWR)
    except OSError:
        return False
    try:
        return os.fstat(file).st_size > 0 and lock_file(file, wait=False)
    except OSError:
        return False
    finally:
        os.close(file)


def _write_all(stream: FileIO, piece: bytes) -> None:
    rest = memoryview(piece)
    while rest:
        rest = rest[stream.write(rest) :]


def has(store: str | PathLike[str], kind: str, key: str) -> bool:
    """Return whether an entry exists, damaged or not."""
    return os.path.isfile(os.path.join(store, kind, key))


def read(path: str | PathLike[str]) -> bytes | None:
    """Return the content of an entry's file without its hash, or None if they do not match. Raises OSError."""
    with open_regular(path, is_source=False) as stream:
        digest, content = stream.read(_DIGEST), stream.read()
    return content if hashlib.sha256(content).digest() == digest else None


@dataclass(frozen=True, slots=True)
class Blob:
    """An entry of one file; `used` is when it was last read or written, in seconds."""

    kind: str
    key: str
    path: Path
    size: int
    used: float

    @property
    def is_damaged(self) -> bool:
        """Whether its content no longer matches its hash."""
        try:
            return read(self.path) is None
        except OSError:
            return True


def blobs_in(store: Path) -> Iterator[Blob]:
    """Yield all entries, in no particular order."""
    for kind in KINDS:
        with contextlib.suppress(OSError), os.scandir(store / kind) as entries:
            for entry in entries:
                status = entry.stat()
                yield Blob(kind, entry.name, Path(entry.path), size=status.st_size, used=status.st_mtime)
