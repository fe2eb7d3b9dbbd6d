"""The MuJoCos of other versions in the store: each in an environment of its own, in `mujoco/VERSION`.

One is complete if it has the file `.ready`, with its size. An environment cannot be moved, so that it is made in its
place, under a lock; what a killed process left of one is made anew, or pruned.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from composer.dataclass import dataclass
from composer.reading.regular import read_regular
from composer.sources.digest import files_below

FOLDER = "mujoco"
READY = ".ready"


@dataclass(frozen=True, slots=True)
class KeptMujoco:
    """A MuJoCo in the store. `size` is in bytes, `used` when it was last started, in seconds."""

    version: str
    folder: Path
    size: int
    used: float

    @property
    def key(self) -> str:
        """The name of its lock and of its lease."""
        return key_of(self.version)


def key_of(version: str) -> str:
    """Return the name of the lock and of the lease of a version.

    >>> key_of("3.12.0")
    'mujoco-3-12-0'
    """
    return f"{FOLDER}-{version.replace('.', '-')}"


def is_complete(folder: Path) -> bool:
    """Return whether the environment in a folder was made to its end."""
    return os.path.isfile(folder / READY)


def complete(folder: Path) -> None:
    """Mark an environment as complete. Raises OSError."""
    (folder / READY).write_text(str(_measured(folder)), encoding="ascii")


def mujocos_in(store: Path) -> Iterator[KeptMujoco]:
    """Yield those that are complete, in no particular order."""
    for folder in _folders(store):
        with contextlib.suppress(OSError):
            used = (folder / READY).stat().st_mtime
            written = read_regular(folder / READY, is_source=False).decode("ascii", "replace").strip()
            yield KeptMujoco(
                folder.name, folder, int(written) if written.isdecimal() else _measured(folder), used=used
            )


def incomplete_in(store: Path) -> list[Path]:
    """Return those that are being made, or were when their process was killed."""
    return [folder for folder in _folders(store) if not is_complete(folder)]


def _folders(store: Path) -> list[Path]:
    with contextlib.suppress(OSError):
        return sorted((store / FOLDER).iterdir())
    return []


def _measured(folder: Path) -> int:
    """Return the size of the files of an environment, without what it links to."""
    size = 0
    for _, path in files_below(folder):
        with contextlib.suppress(OSError):
            size += os.lstat(path).st_size
    return size
