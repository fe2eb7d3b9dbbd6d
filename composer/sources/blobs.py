"""Files of the store that are one piece each, as a compressed asset is: written in one step, hashed when read.

    asked/, built/, raw/, packed/     what the build cache keeps (`composer/cache/cache.py`)
    writing/                          files being written; they move to their place in one step

There is no lock: whoever writes a key writes the same as all others do, or what counts as well as theirs.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from os import PathLike

KINDS = ("asked", "built", "raw", "packed")
WRITING = "writing"
_DIGEST = 32


def key_of(data: object) -> str:
    """A key for data that JSON can hold. No I/O."""
    return hashlib.sha256(json.dumps(data, ensure_ascii=True).encode()).hexdigest()


def get(store: str | PathLike[str], kind: str, key: str) -> bytes | None:
    """What was put, marked as used now; None where it is not there. What is damaged is removed and not there."""
    path = os.path.join(store, kind, key)
    try:
        content = read(path)
    except OSError:
        return None
    with contextlib.suppress(OSError):  # somebody else's store, which may be read
        if content is None:
            os.unlink(path)
        else:
            os.utime(path)
    return content


def put(store: str | PathLike[str], kind: str, key: str, content: bytes) -> None:
    """Write it, complete or not at all. Raises OSError."""
    stage = os.path.join(store, WRITING, f"{key}.{os.urandom(6).hex()}")
    path = os.path.join(store, kind, key)
    try:
        for file in (stage, path):
            os.makedirs(os.path.dirname(file), exist_ok=True)
        with open(stage, "xb") as stream:
            stream.write(hashlib.sha256(content).digest())
            stream.write(content)
        os.replace(stage, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(stage)
        raise


def has(store: str | PathLike[str], kind: str, key: str) -> bool:
    """Whether it is there, damaged or not."""
    return os.path.isfile(os.path.join(store, kind, key))


def read(path: str | PathLike[str]) -> bytes | None:
    """The content of a blob's file, without its hash; None where the two do not agree. Raises OSError."""
    with open(path, "rb") as stream:
        digest, content = stream.read(_DIGEST), stream.read()
    return content if hashlib.sha256(content).digest() == digest else None


@dataclass(frozen=True, slots=True)
class Blob:
    """One such file; `used` is when it was read or written last, in seconds."""

    kind: str
    key: str
    path: Path
    size: int
    used: float

    @property
    def is_damaged(self) -> bool:
        """Whether it is no longer what was put."""
        try:
            return read(self.path) is None
        except OSError:
            return True


def blobs_in(store: Path) -> Iterator[Blob]:
    """All of them, in no order."""
    for kind in KINDS:
        with contextlib.suppress(OSError), os.scandir(store / kind) as entries:
            for entry in entries:
                status = entry.stat()
                yield Blob(kind, entry.name, Path(entry.path), status.st_size, status.st_mtime)
