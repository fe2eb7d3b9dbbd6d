"""Wait until one of several files changes."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import Path
from threading import Event
from typing import Any

from composer.context import Context
from composer.document.node import texts

POLL_SECONDS = 0.15
_SETTLE_SECONDS = 0.02

Mark = tuple[int, int, int] | None
"""Data that changes with a file: its time, its size and its inode. None if it does not exist."""


def marks(files: Iterable[Path]) -> dict[Path, Mark]:
    """Return the marks of files."""
    return {file: _mark(file) for file in files}


def _mark(file: Path) -> Mark:
    try:
        found = os.stat(file)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def hopes(context: Context) -> Iterator[Path]:
    """Yield files that may fix a fault although they were not read: those that recipes name, and those with faults."""
    for recipe, read in context.recipes.items():
        yield context.folder / recipe
        if read.node is not None:
            named = (text for text in texts(read.node) if text.startswith(("./", "../")))
            yield from (context.folder / recipe.parent / text.partition("#")[0] for text in named)
    for each in context.sink.diagnostics:
        if each.span is not None:
            yield context.folder / each.span.file


class Watch:
    """Waits for changes, with `watchfiles` if it is installed, and otherwise by polling.

    It watches folders and not files, because many editors replace a file by renaming.
    """

    def __init__(self, stop: Event) -> None:
        self.stop = stop
        self._watchfiles = _library()

    @property
    def polls(self) -> bool:
        return self._watchfiles is None

    def wait(self, before: dict[Path, Mark]) -> bool:
        """Return True as soon as a file is not as `before`; False once `stop` is set."""
        while not self.stop.is_set():
            if marks(before) != before:
                self.stop.wait(_SETTLE_SECONDS)  # the editor may not be done yet
                return not self.stop.is_set()
            self._sleep({file.parent for file in before})
        return False

    def _sleep(self, folders: set[Path]) -> None:
        """Wait until something happens in the folders, or for a while if that cannot be observed."""
        there = [folder for folder in folders if os.path.isdir(folder)]
        if self._watchfiles is None or not there:
            self.stop.wait(POLL_SECONDS)
            return
        # Network drives and sleeping laptops lose events, so look every few seconds.
        with contextlib.suppress(OSError):
            next(
                self._watchfiles.watch(
                    *there, watch_filter=None, recursive=False, stop_event=self.stop, debounce=50, step=10,
                    rust_timeout=2000, yield_on_timeout=True, raise_interrupt=False,
                ), None,
            )  # fmt: skip
            return
        self.stop.wait(POLL_SECONDS)


def _library() -> Any:
    try:
        return import_module("watchfiles")
    except ImportError:
        return None
