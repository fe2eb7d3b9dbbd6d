"""Track which entries of a store are in use: a process that reads entries holds a lease on them until it ends.

A lease is a file in `leases/` that its process keeps locked and that lists the keys. The system unlocks it when the
process ends for any reason. Looking up or removing an entry happens inside the gate, so that no entry is removed
between the look-up and the lease.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from composer.reading.regular import read_regular

LEASES = "leases"
_GATE = "gate"
_OWN: dict[tuple[str, int], tuple[Path, int, set[str]]] = {}
"""The leases of this process, by store and process id: those of a forked process belong to its parent."""


@contextlib.contextmanager
def gate(store: Path) -> Iterator[None]:
    """Keep other processes from looking up or removing entries. Raises OSError."""
    folder = store / LEASES
    folder.mkdir(parents=True, exist_ok=True)
    file = os.open(folder / _GATE, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o600)
    try:
        lock_file(file)
        yield
    finally:
        os.close(file)


def hold(store: Path, key: str) -> None:
    """Keep an entry from being pruned while this process lives. Call it inside the gate. Raises OSError."""
    own = (os.fspath(store), os.getpid())
    if own not in _OWN:
        held(store)  # also removes leases of killed processes
        path = store / LEASES / f"{os.getpid()}.{os.urandom(6).hex()}"
        file = os.open(
            path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND | getattr(os, "O_CLOEXEC", 0), 0o600
        )
        lock_file(file)
        _OWN[own] = path, file, set()
    _, file, keys = _OWN[own]
    if key not in keys:
        os.write(file, f"{key}\n".encode())
        keys.add(key)


def let_go() -> None:
    """Release all leases of this process, for a program that goes on after a build."""
    for (_, process), (path, file, _) in _OWN.items():
        os.close(file)
        if process == os.getpid():
            with contextlib.suppress(OSError):
                path.unlink()
    _OWN.clear()


atexit.register(let_go)


def held(store: Path) -> set[str]:
    """Return the keys of all entries in use, and remove the leases of ended processes. Call it inside the gate."""
    found: set[str] = set()
    with contextlib.suppress(OSError):
        for path in (store / LEASES).iterdir():
            if path.name == _GATE:
                continue
            with contextlib.suppress(OSError):
                if _is_over(path):
                    path.unlink()
                else:
                    found.update(read_regular(path, is_source=False).decode("ascii").split())
    return found


def _is_over(path: Path) -> bool:
    file = os.open(path, os.O_RDWR)
    try:
        return lock_file(file, wait=False)
    finally:
        os.close(file)


if sys.platform == "win32":
    import msvcrt

    _FAR = 1 << 30
    """The locked byte. On Windows nobody else can read a locked byte."""

    def lock_file(file: int, wait: bool = True) -> bool:
        while True:
            os.lseek(file, _FAR, os.SEEK_SET)
            try:
                msvcrt.locking(file, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
                return True
            except OSError:
                if not wait:
                    return False
else:
    import fcntl

    def lock_file(file: int, wait: bool = True) -> bool:
        """Lock until the file is closed; whether that was possible."""
        try:
            fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            return False
        return True
