"""Cache facts about a file or folder until it changes."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Generic, TypeVar

_MOST = 4096
"""The maximum number of paths in one memory; beyond it, all are looked up again."""
_SETTLED = 2_000_000_000
"""Nanoseconds: changes closer to each other than this may have the same time, as on FAT."""

T = TypeVar("T")


class Memory(Generic[T]):
    """Caches what `look_up` returns for paths, until `stat` shows a change, as git does.

    `missing` returns the value for a path without a `stat`.
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
