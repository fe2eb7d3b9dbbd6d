"""Skin files (`.skn`): their bones name bodies. These references follow a rename like any other."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.reading.regular import read_regular
from composer.tree.files import written_path
from composer.tree.settings import read_settings

_HEADER = struct.Struct("<4i")
_NAME_BYTES = 40
_BIND = 7 * 4


class BadSkin(ValueError):
    """The bytes are not a skin file, or a name does not fit into one."""


class BadBone(BadSkin):
    """A name does not fit into a skin file."""


class Skin(NamedTuple):
    """A skin with a file: the path under which MuJoCo looks for it, and the path as written."""

    element: Node
    path: str
    written: str


def skins(root: Node) -> Iterator[Skin]:
    """Yield every skin of a model that names a file."""
    settings = None
    for section in root.iterchildren("asset", "deformable"):
        for element in section.iterchildren("skin"):
            if written := element.get("file"):
                settings = settings or read_settings(root)
                yield Skin(element, written_path(settings, element, written), str(written))


def renamed_skin(source: bytes | Path, rename: Callable[[str], str | None]) -> bytes | None:
    """Return the file with renamed bones, or None if none changes. Raises `BadBone`.

    `rename` returns None for a name that stays. An unreadable file stays as it is: it is reported where all files
    are read, or by MuJoCo.
    """
    try:
        before = source if isinstance(source, bytes) else read_regular(source)
        after = rename_bones(before, lambda name: rename(name) or name)
    except BadBone:
        raise
    except (OSError, BadSkin):
        return None
    return None if after == before else after


def bones(source: bytes | Path) -> list[str] | None:
    """Return the bodies that a skin file names, or None if it is unreadable."""
    found: list[str] = []

    def note(name: str) -> str:
        found.append(name)
        return name

    try:
        rename_bones(source if isinstance(source, bytes) else read_regular(source), note)
    except (OSError, BadSkin):
        return None
    return found


def rename_bones(data: bytes, rename: Callable[[str], str]) -> bytes:
    """Return the same skin with every bone's body renamed. A name has room for 39 bytes."""
    try:
        vertices, texcoords, faces, bones = _HEADER.unpack_from(data)
        at = _HEADER.size + 4 * (3 * vertices + 2 * texcoords + 3 * faces)
        pieces = [data[:at]]
        for _ in range(bones):
            name = data[at : at + _NAME_BYTES].split(b"\0", 1)[0].decode()
            new = rename(name).encode()
            if len(new) >= _NAME_BYTES:
                raise BadBone(f"the body name `{new.decode()}` is longer than the 39 bytes of a skin file")
            (count,) = struct.unpack_from("<i", data, at + _NAME_BYTES + _BIND)
            end = at + _NAME_BYTES + _BIND + 4 + 8 * count
            pieces += [new.ljust(_NAME_BYTES, b"\0"), data[at + _NAME_BYTES : end]]
            at = end
    except (struct.error, UnicodeDecodeError) as error:
        raise BadSkin("not a skin file") from error
    if at != len(data):
        raise BadSkin("not a skin file")
    return b"".join(pieces)
