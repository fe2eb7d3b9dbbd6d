"""How many pixels a PNG file has: its head says so, and what it unpacks to may be a thousand times its size."""

from __future__ import annotations

import struct

from lxml.etree import _Element as Node

from composer.reading.memory import Memory
from composer.reading.refused import Refused
from composer.reading.regular import read_regular
from composer.tree.files import join, written_path
from composer.tree.unit import Unit

_PNG = b"\x89PNG\r\n\x1a\n"
_HEAD = 24


def pixels(element: Node, attribute: str, unit: Unit) -> int:
    """Those of the file that an attribute names; 0 for one that is no PNG, or is not there."""
    path = written_path(unit.settings, element, str(element.get(attribute)))
    held = unit.contents.get(path)
    if isinstance(held, bytes):
        return _in_head(held[:_HEAD])
    try:
        return _known.ask(unit.door.admit(str(held or join(str(unit.directory), path))))
    except (OSError, Refused):
        return 0


def _in_head(head: bytes) -> int:
    r"""The width times the height.

    >>> _in_head(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\2\0\0\0\3"), _in_head(b"GIF89a")
    (6, 0)
    """
    if len(head) < _HEAD or not head.startswith(_PNG):
        return 0
    width, height = struct.unpack(">II", head[16:_HEAD])
    return int(width * height)


_known: Memory[int] = Memory(lambda path: _in_head(read_regular(path)[:_HEAD]), lambda _: 0)
