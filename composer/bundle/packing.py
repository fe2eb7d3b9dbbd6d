"""Files as a zip holds them, so that what was packed once is copied from then on.

How much a file is packed depends on its name alone: MJCF and other text as far as is usual; meshes lightly, which for
them is nearly as small and several times faster; images and archives, which are packed already, not at all.
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
    """The CRC-32 and the size of a file's bytes, and what a zip holds of it."""

    crc: int
    size: int
    data: bytes


class PackedAhead:
    """The files of a bundle, packed by a thread while this one waits for MuJoCo.

    `find` gives what is known of a file by its hash and its level, None for what is not.
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
        """A file as a zip holds it, and whether it was packed anew; None for one that the bundle did not have then."""
        self._thread.join()
        return self._known.get(digest)

    def end(self) -> None:
        """Nothing more is wanted."""
        self._is_wanted = False
        self._thread.join()
        self._known.clear()


Packing = Callable[[Bundle, str], Packed]
"""Gives a file of a bundle as a zip holds it, by its path."""


def level_of(path: str) -> int:
    """How hard a file is packed, 0 for not at all. No I/O.

    >>> level_of("model.xml"), level_of("assets/arm/link.stl"), level_of("assets/wood.PNG")
    (6, 1, 0)
    """
    suffix = PurePosixPath(path).suffix.lower()
    if suffix in _PACKED:
        return 0
    return _TEXT_LEVEL if suffix in _TEXT else _MESH_LEVEL


def pack(content: bytes, level: int) -> Packed:
    """The bytes as a zip holds them. No I/O."""
    data = content
    if level:
        packer = zlib.compressobj(level, zlib.DEFLATED, -zlib.MAX_WBITS)
        data = packer.compress(content) + packer.flush()
    return Packed(zlib.crc32(content), len(content), data)


def packed_now(bundle: Bundle, path: str) -> Packed:
    """A file of a bundle, packed without anybody's memory."""
    return pack(bundle.files[path], level_of(path))


def wrapped(packed: Packed) -> bytes:
    """All of it as one text of bytes, for a store. No I/O."""
    return _HEAD.pack(packed.crc, packed.size) + packed.data


def unwrapped(content: bytes) -> Packed:
    """What was wrapped. No I/O."""
    crc, size = _HEAD.unpack_from(content)
    return Packed(crc, size, content[_HEAD.size :])
