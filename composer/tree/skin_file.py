"""Skin files (`.skn`): the names of bodies inside them are references like any other."""

from __future__ import annotations

import struct
from collections.abc import Callable

_HEADER = struct.Struct("<4i")
_NAME_BYTES = 40
_BIND = 7 * 4


class BadSkin(ValueError):
    """The bytes are no skin file, or a name does not fit into one."""


class BadBone(BadSkin):
    """A name does not fit into a skin file."""


def rename_bones(data: bytes, rename: Callable[[str], str]) -> bytes:
    """The same skin with every bone's body renamed. A name has room for 39 bytes."""
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
