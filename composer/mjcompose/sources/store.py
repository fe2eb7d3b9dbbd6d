"""The store of fetched files: one folder for each commit or archive, complete or absent.

    git/COMMIT/, archive/SHA256/      content/ and entry.json: its origin, its size, the hash of every file
    asked/, built/, raw/, packed/     entries of the build cache, one file each (`blobs.py`)
    shapes/                           shapes made from meshes, one file each
    seen/                             the commit or hash of a branch, tag or URL at its last look-up
    partial/                          downloads to be resumed
    staging/                          entries being made; they move to their place in one step
    locks/                            one for each entry: two processes do not fetch the same thing at once
    leases/                           one for each process that reads entries: these are not pruned

Every other name is a hash, so no reference can lead outside the store.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import stat
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular, untrusted
from mjcompose.base.limits import parse_size
from mjcompose.sources import blobs
from mjcompose.sources.reference import SourceError

Stored = Literal["git", "archive"]
"""The kind of an entry. It determines the key: a commit hash, or the sha256 of an archive."""
KINDS: tuple[Stored, ...] = get_args(Stored)
ENTRY = "entry.json"
DEFAULT_LIMIT = 10 * 1024**3
GRACE = 3600.0
"""Seconds for which a recently used entry is not pruned automatically: a build may still read it."""
_WAIT = 3600.0


def store_folder(environment: Mapping[str, str]) -> str:
    """Return the absolute path in `MJCOMPOSE_CACHE`, or the system's folder for a user's caches."""
    named = environment.get("MJCOMPOSE_CACHE")
    if named:
        return os.path.abspath(os.path.expanduser(named))
    if sys.platform == "linux" and "ANDROID_ROOT" not in environment:
        # Same as platformdirs, without its import time.
        caches = environment.get("XDG_CACHE_HOME", "")
        return os.path.join(caches if caches.strip() else os.path.expanduser("~/.cache"), "mjcompose")
    from platformdirs import user_cache_dir

    return user_cache_dir("mjcompose", appauthor=False)


class StoreEntry(Struct):
    """One entry of the store; `content` is the folder with its files, and `about` are the fetcher's notes."""

    kind: str
    key: str
    folder: Path
    origin: str
    size: int
    files: Mapping[str, str]
    about: Mapping[str, str]
    used: float

    @property
    def content(self) -> Path:
        return self.folder / "content"


Kept: TypeAlias = StoreEntry | blobs.Blob
"""Entries that a prune may remove."""


class Store(Struct):
    """A folder of entries; `limit` is its maximum size in bytes."""

    folder: Path
    limit: int = DEFAULT_LIMIT

    @classmethod
    def of(cls, environment: Mapping[str, str]) -> Store:
        """Return the user's store: `MJCOMPOSE_CACHE` or the system's cache folder.

        `MJCOMPOSE_CACHE_SIZE` limits its size. Raises SourceError if another user can change it.
        """
        folder = Path(store_folder(environment))
        written = environment.get("MJCOMPOSE_CACHE_SIZE", "")
        limit = parse_size(written) if written else DEFAULT_LIMIT
        if limit is None:
            message = f"`MJCOMPOSE_CACHE_SIZE` is not a size: `{written}`"
            raise SourceError("store-unusable", message, help="write it as `500M` or `10G`")
        why = untrusted(folder)
        if why is not None:
            message = f"the store `{folder}` is not trusted: {why}, who may have put anything there"
            raise SourceError("store-unusable", message, help="name a folder of your own in `MJCOMPOSE_CACHE`")
        return cls(folder, limit)

    def get(self, kind: Stored, key: str) -> StoreEntry | None:
        """Return an entry and keep it from being pruned while this process lives, or None if it does not exist."""
        folder = self.folder / kind / key
        try:
            with blobs.gate(self.folder):
                entry = self._read(kind, folder)
                if entry is not None:
                    blobs.hold(self.folder, key)
        except OSError:  # a read-only store, so nothing is removed either
            entry = self._read(kind, folder)
        if entry is not None:
            with contextlib.suppress(OSError):  # the store of another user may be read-only
                os.utime(folder / ENTRY)
        return entry

    def add(
        self, kind: Stored, key: str, origin: str, fill: Callable[[Path], None], about: Mapping[str, str]
    ) -> StoreEntry:
        """Create an entry: `fill` writes its files into the given empty folder.

        `about` is read afterwards. The caller holds the lock of `key`. The entry is added completely or not at all.
        Raises the errors of `fill`, and SourceError for errors of the disk.
        """
        with self.usable():
            for left in (self.folder / "staging").glob(f"{key}.*"):  # of killed processes: the caller holds the lock
                _erase(left)
            stage = self.folder / "staging" / f"{key}.{os.urandom(6).hex()}"
            try:
                content = stage / "content"
                content.mkdir(parents=True)
                fill(content)
                files = {}
                size = 0
                for name, path in blobs.files_below(content):
                    files[name] = blobs.sha256_of(path)
                    size += path.stat().st_size
                    path.chmod(stat.S_IREAD | stat.S_IRGRP | stat.S_IROTH)
                record = {"origin": origin, "size": size, "about": dict(about), "files": dict(sorted(files.items()))}
                with (stage / ENTRY).open("w", encoding="utf-8") as stream:
                    json.dump(record, stream, indent=1)
                    stream.flush()
                    os.fsync(stream.fileno())
                target = self.folder / kind / key
                target.parent.mkdir(parents=True, exist_ok=True)
                if os.path.lexists(target):  # damaged: an intact one would have been found
                    self._remove(target, key)
                with blobs.gate(self.folder):
                    blobs.hold(self.folder, key)
                    stage.replace(target)
            finally:
                _erase(stage)
        entry = self._read(kind, self.folder / kind / key)
        if entry is None:
            raise SourceError("store-unusable", f"an entry just stored in `{self.folder}` does not exist")
        self.prune(self.limit, keep={key})
        return entry

    @contextlib.contextmanager
    def lock(self, name: str, waiting: Callable[[str], None]) -> Iterator[None]:
        """Exclude other processes from blocks of the same name; a killed process releases the lock."""
        from filelock import FileLock, Timeout

        with self.usable():
            folder = self.folder / "locks"
            folder.mkdir(parents=True, exist_ok=True)
            lock = FileLock(folder / f"{name}.lock")
            try:
                lock.acquire(timeout=0)
            except Timeout:
                waiting("waiting for another mjcompose that fetches the same")
                try:
                    lock.acquire(timeout=_WAIT)
                except Timeout:
                    message = f"another process has held `{lock.lock_file}` for an hour"
                    raise SourceError("store-unusable", message, help="end that process") from None
        try:
            yield
        finally:
            lock.release()

    @contextlib.contextmanager
    def usable(self) -> Iterator[None]:
        """Turn errors of the file system inside the block into a SourceError."""
        try:
            yield
        except (OSError, NotImplementedError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            message = f"the store `{self.folder}` cannot be used: {reason.lower()}"
            help = "make room, or name another folder in `MJCOMPOSE_CACHE`"
            raise SourceError("store-unusable", message, help=help) from error

    def entries(self) -> list[StoreEntry]:
        """Return all intact entries, the least recently used first."""
        entries = []
        for kind in KINDS:
            with contextlib.suppress(OSError):
                for folder in (self.folder / kind).iterdir():
                    entry = self._read(kind, folder)
                    if entry is not None:
                        entries.append(entry)
        return sorted(entries, key=lambda entry: (entry.used, entry.key))

    def prune(self, limit: int, *, grace: float = GRACE, keep: frozenset[str] | set[str] = frozenset()) -> list[Kept]:
        """Remove leftovers of killed processes, and the least recently used entries beyond `limit` bytes.

        Entries in `keep`, entries used in the last `grace` seconds and entries in use by another process stay. Return
        the removed entries.
        """
        removed: list[Kept] = []
        entries = self.entries()
        headless = self.headless(entries)
        everything: list[Kept] = [*entries, *blobs.blobs_in(self.folder)]
        everything.sort(key=lambda each: (each.used, each.key))
        size = sum(each.size for each in everything)
        for each in everything:
            if size <= limit:
                break
            if isinstance(each, blobs.Blob):
                with self.usable():
                    each.path.unlink(missing_ok=True)
            elif each.key in keep or time.time() - each.used < grace or not self._remove_unused(each):
                continue
            removed.append(each)
            size -= each.size
        for left in self.unfinished():
            self._sweep_unless_busy(left)
        with contextlib.suppress(OSError), blobs.gate(self.folder):
            blobs.held(self.folder)  # removes the leases of killed processes
        for folder in headless:
            self.remove_headless(folder)
        return removed

    def remove_content(self, content: Path) -> None:
        """Remove the entry with this folder of files, which is damaged, in one step."""
        with self.usable():
            self._remove(content.parent, content.parent.name)

    def _remove_useless(self, path: Path, key: str, is_useless: Callable[[], bool]) -> None:
        """Remove a path if it is useless, unless another process has the lock of the key."""
        from filelock import FileLock, Timeout

        with contextlib.suppress(Timeout, OSError):
            (self.folder / "locks").mkdir(exist_ok=True)
            with FileLock(self.folder / "locks" / f"{key}.lock", timeout=0):
                if is_useless():
                    self._remove(path, key)

    def _remove_unused(self, entry: StoreEntry) -> bool:
        with self.usable():
            with blobs.gate(self.folder):
                if entry.key in blobs.held(self.folder):
                    return False
                stage = self._moved_away(entry.folder, entry.key)
            _erase(stage)
        return True

    def headless(self, entries: Iterable[StoreEntry]) -> list[Path]:
        """Return entry folders without readable metadata, which no build sees; `entries` are all other entries."""
        known = {entry.folder for entry in entries}
        found: list[Path] = []
        for kind in KINDS:
            with contextlib.suppress(OSError):
                found += (folder for folder in (self.folder / kind).iterdir() if folder not in known)
        return sorted(found)

    def remove_headless(self, folder: Path) -> None:
        """Remove such a folder, unless another process is recreating it."""
        self._remove_useless(folder, folder.name, lambda: self._read(folder.parent.name, folder) is None)

    def unfinished(self) -> list[Path]:
        """Return files that are being created or downloaded, or were left by a killed process."""
        found: list[Path] = []
        for name in ("staging", "partial", blobs.WRITING):
            with contextlib.suppress(OSError):
                found += (self.folder / name).iterdir()
        return sorted(found)

    def damage(self, entry: StoreEntry) -> tuple[str, ...]:
        """Return the damage of an entry, one line for each file; empty if it is intact."""
        there = {}
        for name, path in blobs.files_below(entry.content):
            try:
                there[name] = blobs.sha256_of(path)
            except OSError:
                there[name] = "unreadable"
        return blobs.differences(entry.files, there)

    def remember(self, id: str, seen: Mapping[str, str]) -> None:
        """Record the commit or hash of an origin, if possible."""
        path = self.folder / "seen" / f"{name_of(id)}.json"
        with contextlib.suppress(OSError):
            blobs.write_whole(self.folder, path, json.dumps({**seen, "id": id}).encode())

    def recall(self, id: str) -> Mapping[str, str]:
        """Return the last record of `remember`; empty if there is none."""
        try:
            seen = json.loads(read_regular(self.folder / "seen" / f"{name_of(id)}.json", is_source=False))
        except (OSError, ValueError):
            return {}
        if not isinstance(seen, dict) or seen.get("id") != id:
            return {}
        return {name: value for name, value in seen.items() if isinstance(value, str)}

    def _read(self, kind: str, folder: Path) -> StoreEntry | None:
        try:
            text = read_regular(folder / ENTRY, is_source=False)
            used = (folder / ENTRY).stat().st_mtime
            record: Any = json.loads(text)
            return StoreEntry(
                kind,
                folder.name,
                folder,
                origin=record["origin"],
                size=record["size"],
                files=record["files"],
                about=record["about"],
                used=used,
            )
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def _remove(self, folder: Path, key: str) -> None:
        _erase(self._moved_away(folder, key))

    def _moved_away(self, folder: Path, key: str) -> Path:
        stage = self.folder / "staging" / f"{key}.{os.urandom(6).hex()}"
        stage.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileNotFoundError):  # another process was faster
            folder.replace(stage)
        return stage

    def _sweep_unless_busy(self, left: Path) -> None:
        def is_older_than(seconds: float) -> bool:
            return time.time() - left.stat().st_mtime > seconds

        kind = left.parent.name
        if kind == blobs.WRITING:
            with contextlib.suppress(OSError):
                if blobs.is_left(left) or is_older_than(GRACE):
                    left.unlink()
        else:
            key = left.name.partition(".")[0]
            self._remove_useless(left, key, lambda: kind == "staging" or is_older_than(7 * 24 * 3600))


def name_of(id: str) -> str:
    return hashlib.sha256(id.encode()).hexdigest()


def _erase(path: Path) -> None:
    import shutil  # most builds remove nothing

    if os.path.isdir(path):
        if os.name == "nt":  # Windows does not remove read-only files
            for _, file in blobs.files_below(path):
                with contextlib.suppress(OSError):
                    file.chmod(stat.S_IWRITE)
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            path.unlink()
