"""Compress files for a zip, so that each is compressed only once.

The level depends on the name alone: the usual one for MJCF and other text; a low one for meshes, which is several
times faster and nearly as good; none for images and archives, which are compressed already.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from pathlib import PurePosixPath
from threading import Thread
from typing import NamedTuple

from composer.bundle.bundle import Bundle

_TEXT_LEVEL = 6
_MESH_LEVEL = 1
_TEXT = {".xml", ".json", ".txt", ".md", ".yaml", ".yml", ".csv", ".mtl", ""}
_PACKED = {".png", ".jpg", ".jpeg", ".webp", ".ktx", ".zip", ".mjz", ".gz"}
_HEAD = struct.Struct("<IQ")


class Packed(NamedTuple):
    """The CRC-32 and the size of a file's bytes, and the compressed data."""

    crc: int
    size: int
    data: bytes


class PackedAhead:
    """The files of a bundle, compressed by a thread during MuJoCo's work.

    `find` returns a known compressed file by hash and level, or None.
    """

    def __init__(self, bundle: Bundle, find: Callable[[str, int], Packed | None]) -> None:
        self._known: dict[str, tuple[Packed, bool]] = {}
        self._is_wanted = True
        self._thread = Thread(target=self._pack, args=(bundle, find), daemon=True)
        self._thread.start()

    def _pack(self, bundle: Bundle, find: Callable[[str, int], Packed | None]) -> None:
        for path in bundle.files:
            level = level_of(path)
            if level and self._is_wanted:
                known = find(bundle.digest(path), level)
                self._known[bundle.digest(path)] = known or pack(bundle.files[path], level), known is None

    def take(self, digest: str) -> tuple[Packed, bool] | None:
        """Return a compressed file, and whether it was compressed now; None for a file that the bundle did not have."""
        self._thread.join()
        return self._known.get(digest)

    def end(self) -> None:
        """Stop the thread and discard the files."""
        self._is_wanted = False
        self._thread.join()
        self._known.clear()


Packing = Callable[[Bundle, str], Packed]
"""Returns a file of a bundle in compressed form, by its path."""


def level_of(path: str) -> int:
    """Return the compression level for a file, 0 for none. No I/O.

    >>> level_of("model.xml"), level_of("assets/arm/link.stl"), level_of("assets/wood.PNG")
    (6, 1, 0)
    """
    suffix = PurePosixPath(path).suffix.lower()
    if suffix in _PACKED:
        return 0
    return _TEXT_LEVEL if suffix in _TEXT else _MESH_LEVEL


def pack(content: bytes, level: int) -> Packed:
    """Compress bytes for a zip. No I/O."""
    data = content
    if level:
        packer = zlib.compressobj(level, zlib.DEFLATED, -zlib.MAX_WBITS)
        data = packer.compress(content) + packer.flush()
    return Packed(zlib.crc32(content), len(content), data)


def packed_now(bundle: Bundle, path: str) -> Packed:
    """Compress a file of a bundle without a cache."""
    return pack(bundle.files[path], level_of(path))


def wrapped(packed: Packed) -> bytes:
    """Serialize a compressed file for the store. No I/O."""
    return _HEAD.pack(packed.crc, packed.size) + packed.data


def unwrapped(content: bytes) -> Packed:
    """Parse what `wrapped` returned. No I/O."""
    crc, size = _HEAD.unpack_from(content)
    return Packed(crc, size, content[_HEAD.size :])
