"""Archives on the web: fetched, unpacked within limits, and kept by their sha256."""

from __future__ import annotations

import bz2
import errno
import gzip
import lzma
import math
import re
import stat
import struct
import tarfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Protocol

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import open_regular
from mjcompose.base.limits import MIB, advice, in_force, written
from mjcompose.sources.blobs import differences, sha256_of
from mjcompose.sources.fetching import Fetching, Lookup, not_at_hand, source_in, unlocked
from mjcompose.sources.reference import Origin, Reference, Source, SourceError
from mjcompose.sources.store import Store, StoreEntry, name_of

if TYPE_CHECKING:
    from mjcompose.sources.download import Version

SMALL = 64 * MIB
"""An archive that unpacks to at most this size is not a bomb, whatever its ratio."""


class Unsafe(Exception):
    """An archive is broken or may do harm; the text names the entry and the reason, and `help` says how to allow it."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help


def check(files: int, size: int, packed: int | None = None) -> None:
    """Raise Unsafe if a source of `packed` bytes has more files or bytes than the limits allow."""
    limits = in_force()
    if files > limits.source_files:
        raise Unsafe(f"it holds more than {limits.source_files} files", advice("source-files"))
    if size > limits.source_size:
        most = written("source-size", limits.source_size)
        raise Unsafe(f"it unpacks to more than {most}", advice("source-size"))
    if packed is not None and size > SMALL and size > limits.source_ratio * packed:
        message = f"it unpacks to more than {limits.source_ratio} times its size, as only bombs do"
        raise Unsafe(message, advice("source-ratio", math.ceil(size / max(packed, 1))))


_CHUNK = 1024 * 1024
_HEADER = 16 * _CHUNK
_NAME_MAX = 255
"""The most bytes of a file name."""
_PATH_MAX = 2048
"""The most bytes of a path below the store."""
_DRIVE = re.compile(r"[A-Za-z]:")
_OPENERS: tuple[tuple[bytes, Any], ...] = (
    (b"\x1f\x8b", gzip.open),
    (b"BZh", bz2.open),
    (b"\xfd7zXZ\x00", lzma.open),
)


_BROKEN = (
    zipfile.BadZipFile,
    tarfile.TarError,
    zlib.error,
    lzma.LZMAError,
    EOFError,
    NotImplementedError,
    gzip.BadGzipFile,
    ValueError,
    RuntimeError,
    struct.error,
    OverflowError,
    IndexError,
)
_OF_THE_DISK = frozenset({errno.EIO, errno.ENOSPC, errno.EDQUOT, errno.ENXIO, errno.EBADF})


def unpack(archive: Path, target: Path) -> None:
    """Unpack a zip or a tar (plain, gz, bz2 or xz), recognized by its bytes, into `target`, an empty folder.

    Raises Unsafe for an archive that is broken, encrypted or larger than the limits, that leads outside the folder, or
    that has links, devices or duplicate names; OSError for errors of the disk.
    """
    size = in_force().source_size
    with open_regular(archive, size, is_source=False) as stream:
        start = stream.read(512)
    packed = archive.stat().st_size
    try:
        if start.startswith((b"PK\x03\x04", b"PK\x05\x06")):
            with open_regular(archive, size, is_source=False) as raw, zipfile.ZipFile(raw) as opened:
                _write(_zip_members(opened), target, packed)
            return
        opener = next((opener for magic, opener in _OPENERS if start.startswith(magic)), None)
        if opener is None and start[257:262] != b"ustar":
            looks = ": it looks like a web page" if start.lstrip()[:1] == b"<" else ""
            raise Unsafe(f"it is neither a zip nor a tar{looks}")
        raw = open_regular(archive, size, is_source=False)
        with raw, raw if opener is None else opener(raw) as plain:
            bounded: Any = _Bounded(plain)
            with tarfile.open(fileobj=bounded, mode="r:") as tar:
                _write(_tar_members(tar), target, packed)
    except _BROKEN as fault:
        raise Unsafe(f"it is broken: {str(fault) or type(fault).__name__}") from fault
    except OSError as fault:
        # bz2 and zipfile report foreign bytes by an error without a number, or with the number of an invalid argument.
        if fault.errno in (None, errno.EINVAL):
            raise Unsafe(f"it is broken: {str(fault).lower()}") from fault
        raise


def check_name(name: str) -> None:
    """Raise Unsafe for a path that is not below a folder on every system. No I/O."""
    parts = name.split("/")
    if not name or name.startswith("/") or "\\" in name or _DRIVE.match(name) or ".." in parts:
        raise Unsafe(f"`{name}` leads outside its folder")
    if any(character < " " or character == "\x7f" for character in name):
        raise Unsafe(f"{name!r} has a control character in its name")
    sizes = [len(part.encode("utf-8", "surrogateescape")) for part in parts]
    if max(sizes) > _NAME_MAX or sum(sizes) + len(sizes) > _PATH_MAX:
        raise Unsafe(f"`{name[:60]}…` is longer than a name of a file can be")


def _zip_members(archive: zipfile.ZipFile) -> Iterator[tuple[str, IO[bytes] | None]]:
    members = archive.infolist()
    check(len(members), sum(member.file_size for member in members))
    for member in members:
        kind = stat.S_IFMT(member.external_attr >> 16)
        if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
            raise Unsafe(f"`{member.filename}` is {_KINDS.get(kind, 'no plain file')}")
        if member.flag_bits & 1:
            raise Unsafe(f"`{member.filename}` is encrypted")
        if member.is_dir():
            yield member.filename.rstrip("/"), None
        else:
            # Check the name in the archive: zipfile itself sanitizes names.
            with archive.open(member) as stream:
                yield member.orig_filename, stream


_KINDS = {
    stat.S_IFLNK: "a link",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
}


def _tar_members(archive: tarfile.TarFile) -> Iterator[tuple[str, IO[bytes] | None]]:
    for member in archive:
        if member.issym() or member.islnk():
            raise Unsafe(f"`{member.name}` is a link")
        if member.isdir():
            yield member.name, None
        elif member.isreg():
            yield member.name, archive.extractfile(member)
        else:
            raise Unsafe(f"`{member.name}` is {'a pipe' if member.isfifo() else 'a device'}")


def _write(members: Iterator[tuple[str, IO[bytes] | None]], target: Path, packed: int) -> None:
    count = size = 0
    for name, stream in members:
        name = name.removeprefix("./")
        if name in ("", ".") and stream is None:
            continue
        check_name(name)
        count += 1
        check(count, size, packed)
        path = target / name
        try:
            if stream is None:
                path.mkdir(parents=True, exist_ok=True)
                continue
            path.parent.mkdir(parents=True, exist_ok=True)
            file = path.open("xb")
        except (FileExistsError, NotADirectoryError):
            raise Unsafe(f"it holds `{name}` twice") from None
        with file:
            while chunk := _read(stream, name):
                size += len(chunk)
                check(count, size, packed)
                file.write(chunk)


def _read(stream: IO[bytes], name: str) -> bytes:
    try:
        return stream.read(_CHUNK)
    except OSError as fault:
        if fault.errno in _OF_THE_DISK:
            raise
        raise Unsafe(f"`{name}` in it is broken: {str(fault).lower()}") from fault
    except _BROKEN as fault:
        raise Unsafe(f"`{name}` in it is broken: {str(fault).lower() or type(fault).__name__}") from fault


class _Bounded:
    """A stream that refuses large reads, which only a forged header requests."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self.tell = stream.tell
        self.seek = stream.seek

    def read(self, size: int = -1) -> bytes:
        if not 0 <= size <= _HEADER:
            raise Unsafe("it has a header of absurd size")
        return self._stream.read(size)


class Download(Protocol):
    """Writes the archive at `url` to `partial`, or returns None if it still has the version `known`."""

    def __call__(self, url: str, partial: Path, known: Version, *, lookup: Lookup) -> Version | None: ...


def resolve(reference: Reference, lookup: Lookup, download: Download | None = None) -> Source:
    """Return the file in an archive. Raises SourceError.

    Archives that the lock or the reference pins come from the store, or else are fetched. Unpinned archives are fetched
    again if the server says that they have changed.
    """
    id = reference.id
    known = lookup.fetching.origins
    if id not in known:
        store = Store.of(lookup.environment)
        if download is None:
            from mjcompose.sources.download import download as over_http  # slow to import

            download = over_http
        entry = _Archive(reference, id, store, lookup=lookup, download=download).entry()
        known[id] = Origin(id, reference.kind, entry.content, sha256=entry.key, stored=entry.files)
    return source_in(known[id], reference)


class _Archive(Struct):
    reference: Reference
    id: str
    store: Store
    lookup: Lookup
    download: Download

    @property
    def fetching(self) -> Fetching:
        return self.lookup.fetching

    def entry(self) -> StoreEntry:
        written = self.reference.revision
        locked = self.fetching.pin(self.id)
        if written and locked and written != locked:
            message = f"`{self.reference.text}` gives a different sha256 than the lock, which has {locked[:12]}…"
            help = f"run `mjcompose lock {self.fetching.recipe} --upgrade-source {self.id}`"
            raise SourceError("lock-stale", message, help=help)
        if locked is None and self.fetching.locked:
            raise unlocked(self.reference, self.fetching)
        wanted = written or locked
        seen = self.store.recall(self.id)
        at_hand = wanted or seen.get("sha256") or ""
        entry = self.store.get("archive", at_hand) if at_hand else None
        if entry is not None and (wanted or self.fetching.offline):
            return entry
        if self.fetching.offline:
            raise not_at_hand(self.reference)
        with self.store.lock(name_of(self.id), self.fetching.progress), self.store.usable():
            # Another process may have fetched it in the meantime.
            if wanted and (entry := self.store.get("archive", wanted)) is not None:
                return entry
            return self._fetched(wanted, entry, seen)

    def _fetched(self, wanted: str | None, had: StoreEntry | None, seen: Mapping[str, str]) -> StoreEntry:
        # Slow to import, and only needed for downloads.
        from mjcompose.sources.download import Version, forget

        partial = self.store.folder / "partial" / f"{name_of(self.id)}.part"
        partial.parent.mkdir(parents=True, exist_ok=True)
        url = self.reference.name
        self.fetching.progress(f"fetching {url}")
        known = Version(seen.get("etag", ""), seen.get("modified", "")) if had is not None else Version()
        version = self.download(url, partial, known, lookup=self.lookup)
        if version is None:
            assert had is not None, "only a known version can be unchanged"
            return had
        try:
            sha256 = sha256_of(partial)
            entry = self.store.get("archive", sha256)
            if entry is None:
                with self.store.lock(sha256, self.fetching.progress):
                    entry = self.store.add("archive", sha256, self.id, lambda target: unpack(partial, target), {})
        except Unsafe as fault:
            forget(partial)
            if wanted and sha256 != wanted:
                raise self._changed(wanted, sha256, (f"its new contents are refused: {fault}",)) from None
            raise SourceError("archive-refused", f"the archive `{url}` is refused: {fault}", help=fault.help) from None
        forget(partial)
        if wanted and sha256 != wanted:
            before = self.fetching.known_files(self.id)
            there = {name: digest for name, digest in entry.files.items() if name in before}
            raise self._changed(wanted, sha256, differences(before, there))
        self.store.remember(self.id, {"sha256": sha256, "etag": version.etag, "modified": version.modified})
        return entry

    def _changed(self, wanted: str, sha256: str, changes: tuple[str, ...]) -> SourceError:
        pinned = "the reference"
        help = "if you want that archive, write the new sha256"
        if not self.reference.revision:
            upgrade = f"mjcompose lock {self.fetching.recipe} --upgrade-source {self.id}"
            pinned = "the lock"
            help = f"look at its contents, then run `{upgrade}`"
        message = f"the archive `{self.reference.name}` differs from the archive that {pinned} pins"
        notes = (f"sha256 {wanted} is pinned, {sha256} is there", *changes[:8])
        return SourceError("source-changed", message, notes=notes, help=help)
