"""Files of the store that are one piece each, as a compressed asset is: written in one step, hashed when read.

    asked/, built/, raw/, packed/     what the build cache keeps (`composer/build/cache.py`)
    writing/                          files being written; they move to their place in one step

There is no lock: whoever writes a key writes the same as all others do, or what counts as well as theirs.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

BLOB_KINDS = ("asked", "built", "raw", "packed")
WRITING = "writing"
_DIGEST = 32


@dataclass(frozen=True, slots=True)
class Blob:
    """One such file; `used` is when it was read or written last, in seconds."""

    kind: str
    key: str
    path: Path
    size: int
    used: float


def get(store: Path, kind: str, key: str) -> bytes | None:
    """What was put, marked as used now; None where it is not there. What is damaged is removed and not there."""
    path = store / kind / key
    try:
        content = _read(path)
    except OSError:
        return None
    with contextlib.suppress(OSError):  # somebody else's store, which may be read
        if content is None:
            path.unlink()
        else:
            os.utime(path)
    return content


def put(store: Path, kind: str, key: str, content: bytes) -> None:
    """Write it, complete or not at all. Raises OSError."""
    stage = store / WRITING / f"{key}.{os.urandom(6).hex()}"
    path = store / kind / key
    try:
        for folder in (stage.parent, path.parent):
            folder.mkdir(parents=True, exist_ok=True)
        with stage.open("xb") as stream:
            stream.write(hashlib.sha256(content).digest())
            stream.write(content)
        stage.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            stage.unlink()
        raise


def has(store: Path, kind: str, key: str) -> bool:
    """Whether it is there, damaged or not."""
    return (store / kind / key).is_file()


def is_damaged(blob: Blob) -> bool:
    """Whether it is no longer what was put."""
    try:
        return _read(blob.path) is None
    except OSError:
        return True


def blobs(store: Path) -> Iterator[Blob]:
    """All of them, in no order."""
    for kind in BLOB_KINDS:
        with contextlib.suppress(OSError), os.scandir(store / kind) as entries:
            for entry in entries:
                status = entry.stat()
                yield Blob(kind, entry.name, Path(entry.path), status.st_size, status.st_mtime)


def _read(path: Path) -> bytes | None:
    """The content without its hash; None where the two do not agree. Raises OSError."""
    with path.open("rb") as stream:
        digest, content = stream.read(_DIGEST), stream.read()
    return content if hashlib.sha256(content).digest() == digest else None
