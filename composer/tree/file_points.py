"""Count the points in the file of a `<flexcomp>` before MuJoCo makes bodies of them: each may become one."""

from __future__ import annotations

import struct

from lxml.etree import _Element as Node

from composer.reading.refused import Refused
from composer.tree.files import join, written_path
from composer.tree.unit import Unit

_FACE = 50
"""Bytes of a face in a binary STL file."""


def file_points(flexcomp: Node, unit: Unit) -> int:
    """Return a lower bound of the points in the file; 0 if it does not exist, which is reported elsewhere."""
    written = written_path(unit.settings, flexcomp, str(flexcomp.get("file") or ""))
    held = unit.contents.get(written)
    if isinstance(held, bytes):
        return points(held, written)
    try:
        return points(unit.door.read(held or join(str(unit.directory), written)), written)
    except (OSError, Refused):
        return 0


def points(data: bytes, name: str) -> int:
    r"""Return a lower bound of the points of a mesh file.

    >>> points(b"v 0 0 0\nv 1 0 0\nvn 1 0 0\n", "a.obj"), points(b"$Nodes\n1 8 1 8\n", "a.msh")
    (2, 8)
    """
    kind = name.lower().rpartition(".")[2]
    if kind == "obj":
        return data.count(b"\nv ") + data.startswith(b"v ")
    if kind == "stl":
        return max(0, len(data) - 84) // _FACE // 2  # a closed surface has half as many points as faces
    if b"$Nodes" in data[:10_000]:
        numbers = data.partition(b"$Nodes")[2][:200]
        return _nodes(numbers)
    return struct.unpack("<i", data[:4])[0] if kind == "msh" and len(data) >= 4 else 0


def _nodes(numbers: bytes) -> int:
    """Return the number of nodes in gmsh 4 (blocks, nodes, lowest, highest) and gmsh 2 (nodes).

    Binary files use 64 bits.
    """
    first = numbers.split(b"\n")[1:2]
    words = first[0].split() if first else []
    if words and all(word.isdigit() for word in words):
        return int(words[1] if len(words) == 4 else words[0])
    binary = numbers[1:17]
    return int(struct.unpack("<2Q", binary)[1]) if len(binary) == 16 else 0
