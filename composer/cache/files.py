"""Detect changes of files: by their stamps, and by content if these differ."""

from __future__ import annotations

import hashlib
import os
import stat
import time
from dataclasses import field

from composer.dataclass import dataclass
from composer.reading import sources
from composer.reading.regular import open_regular
from composer.sources.licence import licence_names

Stamp = tuple[int, int, int, int]
"""Data that changes with a file as far as `stat` shows: size, times of the last change of content and of the inode
in ns, and inode.
"""

ABSENT = ""
# A file that changed this recently may change again without a new stamp, so its content is compared.
_SETTLED = 2_000_000_000


@dataclass(frozen=True, slots=True)
class Seen:
    """The state of a path: the sha256 of a file, the names of a folder's licences, or `ABSENT`."""

    path: str
    state: str
    stamp: Stamp | None

    def as_data(self) -> list[object]:
        return [self.path, self.state, self.stamp]


def seen(data: list[object]) -> Seen:
    """Parse what `as_data` returned. Raises TypeError and ValueError for anything else."""
    path, state, stamp = data
    if not isinstance(path, str) or not isinstance(state, str):
        raise TypeError(data)
    return Seen(path, state, tuple(stamp) if isinstance(stamp, list) else None)


@dataclass(slots=True)
class Files:
    """Looks at every file once until `forget`, and reads it again only if its stamp changed."""

    _stamps: dict[str, tuple[Stamp, bool] | None] = field(default_factory=dict)
    _states: dict[tuple[str, Stamp], str] = field(default_factory=dict)

    def look(self, path: str) -> Seen:
        """Return the current state."""
        stamped = self._stamp(path)
        if stamped is None:
            return Seen(path, ABSENT, None)
        stamp, is_folder = stamped
        key = path, stamp
        if key not in self._states:
            self._states[key] = _licences(path) if is_folder else _sha256(path)
        settled = max(stamp[1], stamp[2]) + _SETTLED < time.time_ns()
        return Seen(path, self._states[key], stamp if settled else None)

    def forget(self) -> None:
        """Look at files again from now on."""
        self._stamps.clear()

    def is_same(self, before: Seen) -> bool:
        """Return whether the state is unchanged."""
        stamped = self._stamp(before.path)
        if stamped is None or before.stamp is None or stamped[0] != before.stamp:
            return self.look(before.path).state == before.state
        return True

    def changed_since(self, path: str, moment: int) -> bool:
        """Return whether a file was written after a moment, in ns since 1970."""
        stamped = self._stamp(path)
        return stamped is not None and not stamped[1] and max(stamped[0][1:3]) > moment

    def _stamp(self, path: str) -> tuple[Stamp, bool] | None:
        if path not in self._stamps:
            try:
                status = os.stat(path)
            except (OSError, ValueError):
                self._stamps[path] = None
            else:
                is_folder = stat.S_ISDIR(status.st_mode)
                if not is_folder:
                    sources.current().note((path,))
                self._stamps[path] = stamp_of(status), is_folder
        return self._stamps[path]


def stamp_of(status: os.stat_result) -> Stamp:
    """Return the stamp for a file's status. No I/O."""
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino


def now() -> int:
    """Return the file system's time in ns since 1970: later writes are not older."""
    coarse = getattr(time, "CLOCK_REALTIME_COARSE", None)
    return time.time_ns() if coarse is None else time.clock_gettime_ns(coarse)


def _sha256(path: str) -> str:
    try:
        with open_regular(path) as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ABSENT


def _licences(folder: str) -> str:
    try:
        return licence_names(folder)
    except OSError:
        return ABSENT
