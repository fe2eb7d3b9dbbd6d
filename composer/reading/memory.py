"""What was found out of a file or folder, as long as it stays the same."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Generic, TypeVar

_MOST = 4096
"""Files and folders that one memory keeps; when there are more, all are looked up anew."""
_SETTLED = 2_000_000_000
"""Nanoseconds: changes that are nearer to one another than this may have one time, as on FAT."""

T = TypeVar("T")


class Memory(Generic[T]):
    """What `look_up` says of paths: asked once, and again as soon as one look (`stat`) says that something changed.

    That is what git does. `missing` says what holds for a path that cannot be looked at.
    """

    def __init__(self, look_up: Callable[[str], T], missing: Callable[[str], T]) -> None:
        self._look_up, self._missing = look_up, missing
        self._known: dict[str, tuple[tuple[int, ...], T]] = {}

    def ask(self, path: str) -> T:
        try:
            status = os.stat(path)
        except (OSError, ValueError):
            return self._missing(path)
        changed = max(status.st_mtime_ns, status.st_ctime_ns)
        state = (
            status.st_dev, status.st_ino, status.st_nlink, status.st_size, status.st_mtime_ns, status.st_ctime_ns
        )  # fmt: skip
        known = self._known.get(path)
        if known is not None and known[0] == state:
            return known[1]
        found = self._look_up(path)
        if time.time_ns() - changed > _SETTLED:
            if len(self._known) >= _MOST:
                self._known.clear()
            self._known[path] = state, found
        return found
