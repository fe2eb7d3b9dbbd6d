"""Temporary folders, locked while in use.

The next run removes those of killed processes.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import shutil
import stat
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

PREFIX = "mjcompose-"
_LOCK = "lock"
_NEW = "new"
_FILES = "files"
_GRACE = 3600.0
_SCRATCH = re.compile(rf"[/\\]{PREFIX}[a-z]+-[0-9a-f]{{12}}[/\\]{_FILES}(?:[/\\]|$)")
_swept: set[tuple[str, str]] = set()


@contextmanager
def scratch(purpose: str) -> Iterator[Path]:
    """Yield an empty temporary folder. Raises OSError.

    >>> with scratch("example") as folder:
    ...     folder.is_dir(), folder.parent.name.startswith("mjcompose-example-")
    (True, True)
    """
    with locked_folder(sweep_temporary() / f"{PREFIX}{purpose}-{secrets.token_hex(6)}") as folder:
        files = folder / _FILES
        files.mkdir()
        yield files


def is_scratch(path: str) -> bool:
    """Return whether a path leads into a folder of `scratch`. No I/O."""
    return f"{os.sep}{PREFIX}" in path and _SCRATCH.search(path) is not None


def sweep_temporary() -> Path:
    """Remove leftovers of killed processes from the folder for temporary files and return it; once in this process."""
    import tempfile  # few calls need it

    parent = Path(tempfile.gettempdir())
    sweep_once(parent, _is_ours)
    return parent


def _is_ours(name: str) -> bool:
    return name.startswith(PREFIX)


@contextmanager
def locked_folder(folder: Path) -> Iterator[Path]:
    """Create a folder that is locked for the block and then removed, except in a forked process. Raises OSError."""
    owner = os.getpid()
    folder.mkdir(mode=0o700)
    try:
        lock = os.open(folder / _NEW, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            _lock(lock)
            if os.name == "posix":  # on Windows, open files can be neither renamed nor removed
                os.replace(folder / _NEW, folder / _LOCK)
            yield folder
        finally:
            if os.getpid() == owner:
                _empty(folder)
            os.close(lock)
    finally:
        if os.getpid() == owner:
            shutil.rmtree(folder, ignore_errors=True)


def sweep_once(parent: Path, is_ours: Callable[[str], bool], save: Callable[[Path], None] | None = None) -> None:
    """Remove locked folders whose process has ended, once in this process; `save` rescues their contents.

    Anyone may have put folders with such names there, so a fault in one of them ends neither the sweep nor the command.
    """
    key = str(parent), getattr(is_ours, "__qualname__", "")
    if key in _swept:
        return
    _swept.add(key)
    with contextlib.suppress(OSError), os.scandir(parent) as entries:
        for entry in entries:
            if is_ours(entry.name):
                with contextlib.suppress(Exception):
                    sweep(Path(entry.path), save)


def sweep(folder: Path, save: Callable[[Path], None] | None = None) -> bool:
    """Remove a locked folder if its process has ended; return whether it was removed."""
    with contextlib.suppress(OSError):
        status = folder.lstat()
        if not stat.S_ISDIR(status.st_mode) or (hasattr(os, "getuid") and status.st_uid != os.getuid()):
            return False
        if os.name != "posix":
            (folder / _NEW).unlink()  # Windows refuses this while the file is open: that is the lock there
            return _remove(folder, save)
        if not os.path.exists(folder / _LOCK):
            is_new = time.time() - status.st_mtime < _GRACE or set(os.listdir(folder)) - {_NEW}
            return not is_new and _remove(folder, None)  # its process was killed before it had the lock
        lock = os.open(folder / _LOCK, os.O_RDWR | os.O_NOFOLLOW)
        try:
            return _lock(lock) and _remove(folder, save)
        finally:
            os.close(lock)
    return False


def _remove(folder: Path, save: Callable[[Path], None] | None) -> bool:
    if save is not None:
        save(folder)
    _empty(folder)
    shutil.rmtree(folder, ignore_errors=True)
    return True


def _empty(folder: Path) -> None:
    """Remove everything except the lock: without it, leftovers of a process that is killed now would never be swept."""
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name in (_LOCK, _NEW):
                continue
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                os.unlink(entry.path)


def _lock(file: int) -> bool:
    if sys.platform == "win32":
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
