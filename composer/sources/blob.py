"""The blobs of a store as what takes room in it and may be damaged."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from composer.sources import blobs

KINDS = ("asked", "built", "raw", "packed")


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
            return blobs.read(self.path) is None
        except OSError:
            return True


def blobs_in(store: Path) -> Iterator[Blob]:
    """All of them, in no order."""
    for kind in KINDS:
        with contextlib.suppress(OSError), os.scandir(store / kind) as entries:
            for entry in entries:
                status = entry.stat()
                yield Blob(kind, entry.name, Path(entry.path), status.st_size, status.st_mtime)
