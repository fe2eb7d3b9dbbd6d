"""Single files of the store, and leases on its entries.

`store.py` lists the folders. A process keeps its file in `leases/` locked; the file lists the entries in use.

Files need no lock: all writers of a key write the same content, or content that is as good. The system unlocks a lease
when its process ends for any reason. Looking up or removing an entry happens inside the gate, so no entry is removed
between the look-up and the lease.
"""

from __future__ import annotations

import atexit
import contextlib
import hashlib
import json
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import Memory, open_regular, read_regular, unsaved_text

if TYPE_CHECKING:
    from os import PathLike


def sha256_of(path: Path) -> str:
    """Return the sha256 of a file, or of the text that an editor has not saved yet. Raises OSError."""
    kept = unsaved_text(path)
    if kept is not None:
        return hashlib.sha256(kept).hexdigest()
    with open_regular(path) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


_remembered = Memory(lambda path: sha256_of(Path(path)), lambda path: sha256_of(Path(path)))


def remembered_sha256(path: Path) -> str:
    """Return the sha256 of a file that many models of a run use; it is read again only if it has changed."""
    return sha256_of(path) if unsaved_text(path) is not None else _remembered.ask(os.fspath(path))


def files_below(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield every file below a folder with its relative POSIX path, in no order; links are not followed."""
    for where, _, names in os.walk(folder):
        for name in names:
            path = Path(where, name)
            yield path.relative_to(folder).as_posix(), path


def differences(before: Mapping[str, str], after: Mapping[str, str]) -> tuple[str, ...]:
    """Return one line for each file that changed, sorted by name; empty if none has. No I/O."""
    return tuple(
        f"`{name}` is gone"
        if name not in after
        else f"`{name}` is new"
        if name not in before
        else f"`{name}` changed: {before[name][:12]}… was locked, {after[name][:12]}… is there"
        for name in sorted({*before, *after})
        if before.get(name) != after.get(name)
    )


LEASES = "leases"
_GATE = "gate"
_OWN: dict[tuple[str, int], tuple[Path, int, set[str]]] = {}
"""The leases of this process, by store and process id: leases of a forked process belong to its parent."""


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
        file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND | getattr(os, "O_CLOEXEC", 0), 0o600)
        lock_file(file)
        _OWN[own] = path, file, set()
    _, file, keys = _OWN[own]
    if key not in keys:
        os.write(file, f"{key}\n".encode())
        keys.add(key)


def let_go() -> None:
    """Release all leases of this process, for a program that continues after a build."""
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
                file = os.open(path, os.O_RDWR)
                try:
                    is_over = lock_file(file, wait=False)
                finally:
                    os.close(file)
                if is_over:
                    path.unlink()
                else:
                    found.update(read_regular(path, is_source=False).decode("ascii").split())
    return found


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
        """Lock until the file is closed, and return whether that was possible."""
        try:
            fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            return False
        return True


KINDS = ("asked", "built", "raw", "packed", "shapes")
WRITING = "writing"
_DIGEST = 32


def key_of(data: object) -> str:
    return hashlib.sha256(json.dumps(data, ensure_ascii=True).encode()).hexdigest()


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def get(store: str | PathLike[str], kind: str, key: str) -> bytes | None:
    """Return an entry and mark it as used now, or None if it does not exist; a damaged entry is removed."""
    path = os.path.join(store, kind, key)
    try:
        content = read(path)
    except OSError:
        return None
    with contextlib.suppress(OSError):  # the store of another user may be read-only
        if content is None:
            os.unlink(path)
        else:
            os.utime(path)
    return content


def put(store: str | PathLike[str], kind: str, key: str, content: bytes) -> None:
    """Write an entry completely or not at all. Raises OSError."""
    write_whole(store, os.path.join(store, kind, key), hashlib.sha256(content).digest(), content)


def write_whole(store: str | PathLike[str], path: str | PathLike[str], *pieces: bytes) -> None:
    """Write a file of the store completely or not at all, locked until then. Raises OSError."""
    stage = os.path.join(store, WRITING, f"{os.path.basename(path)}.{os.urandom(6).hex()}")
    try:
        for file in (stage, path):
            os.makedirs(os.path.dirname(file), exist_ok=True)
        with open(stage, "xb", buffering=0) as stream:
            with contextlib.suppress(OSError):  # on a file system without locks, leftovers are removed after a time
                lock_file(stream.fileno(), wait=False)
            for piece in pieces:
                rest = memoryview(piece)
                while rest:
                    rest = rest[stream.write(rest) :]
            if os.name == "posix":  # other systems cannot rename an open file
                os.replace(stage, path)
        if os.name != "posix":
            os.replace(stage, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(stage)
        raise


def is_left(stage: str | PathLike[str]) -> bool:
    """Return whether a staged file was left by a killed process. An empty file may not be locked yet."""
    with contextlib.suppress(OSError):
        file = os.open(stage, os.O_RDWR)
        try:
            return os.fstat(file).st_size > 0 and lock_file(file, wait=False)
        finally:
            os.close(file)
    return False


def has(store: str | PathLike[str], kind: str, key: str) -> bool:
    """Return whether an entry exists, damaged or not."""
    return os.path.isfile(os.path.join(store, kind, key))


def read(path: str | PathLike[str]) -> bytes | None:
    """Return the content of an entry's file without its hash, or None if they do not match. Raises OSError."""
    with open_regular(path, is_source=False) as stream:
        digest = stream.read(_DIGEST)
        content = stream.read()
    return content if hashlib.sha256(content).digest() == digest else None


class Blob(Struct):
    """An entry of one file; `used` is when it was last read or written, in seconds."""

    kind: str
    key: str
    path: Path
    size: int
    used: float

    @property
    def is_damaged(self) -> bool:
        """Whether its content no longer matches its hash."""
        try:
            return read(self.path) is None
        except OSError:
            return True


def blobs_in(store: Path) -> Iterator[Blob]:
    """Yield all entries, in no particular order."""
    for kind in KINDS:
        with contextlib.suppress(OSError), os.scandir(store / kind) as entries:
            for entry in entries:
                status = entry.stat()
                yield Blob(kind, entry.name, Path(entry.path), size=status.st_size, used=status.st_mtime)
