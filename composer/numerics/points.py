"""How many points the file of a mesh has: counted in its bytes, before MuJoCo makes anything of them."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator

_FACE = 50
"""Bytes of a face in a binary STL file."""
_HEAD = 84
_PIECE = 1 << 24
_INDENTED = re.compile(rb"\n +")
_LONG = 1000
"""Corners from which on the cutting of a polygon costs more than its points."""
_CUT = 4000
_SMALL = 1 << 15
"""Bytes of an OBJ file that need not be looked at: it has too few points to matter."""


def points_in(data: bytes, kind: str) -> int:
    r"""At least so many points that a file has, and at least half as many as faces; `kind` is how its name ends.

    >>> points_in(b"v 0 0 0\nv 1 0 0\nvn 1 0 0\n", "obj"), points_in(b"$Nodes\n1 8 1 8\n", "msh")
    (2, 8)
    """
    if kind == "obj":
        return _of_obj(data)
    if kind == "stl":
        return _of_stl(data)
    if b"$Nodes" in data[:10_000]:
        return _of_gmsh(data.partition(b"$Nodes")[2][:200])
    if kind == "msh" and len(data) >= 16:
        points, _, _, faces = map(int, struct.unpack("<4i", data[:16]))
        return max(points, faces // 2, 0)
    return 0


def most_points(size: int, kind: str) -> int | None:
    """Return an upper bound of the points of a file with so many bytes; None if only its bytes can tell.

    >>> most_points(84 + 50 * 12, "stl"), most_points(1000, "obj")
    (36, 312)
    """
    if kind == "obj":  # a line of a point or a face has six bytes or more, a corner of a polygon two
        return size // 4 + (size // 2) ** 2 // _CUT if size <= _SMALL else None
    return 3 * (max(0, size - _HEAD) // _FACE) if kind == "stl" else None


def most_points_in(data: bytes, kind: str) -> int | None:
    r"""Return an upper bound of the points of a file, much faster than counting them; None if only that can tell.

    >>> most_points_in(b"v 0 0 0\n" * 10_000, "obj"), most_points_in(b"f" + b" 1" * 20_000, "obj")
    (20000, None)
    """
    if kind != "obj" or len(data) <= _SMALL:
        return most_points(len(data), kind)
    # A line of so many corners, of two bytes or more, fills at least one of these windows.
    windows = range(0, len(data), _LONG)
    is_long = any(data.find(b"\n", begin, begin + _LONG) < 0 for begin in windows[:-1])
    # Two triangles weigh as much as a point; each has a corner of its own.
    return None if is_long else max(data.count(b"\n") + data.count(b"\r") + 1, len(data) // 4)


def _of_stl(data: bytes) -> int:
    """MuJoCo joins the corners that are equal."""
    import numpy as np

    faces = max(0, len(data) - _HEAD) // _FACE
    rows = np.frombuffer(data, np.uint8, faces * _FACE, _HEAD).reshape(faces, _FACE) if faces else None
    if rows is None:
        return 0
    corners = np.ascontiguousarray(rows[:, 12:48]).view("<u4").reshape(-1, 3).astype(np.uint64)
    # Odd numbers that nobody else knows: a file cannot be made so that other points seem equal.
    factors = np.frombuffer(_secret(), np.uint64) | np.uint64(1)
    mixed = corners * factors
    mixed ^= mixed >> np.uint64(29)
    return max(len(np.unique((mixed * factors[::-1]).sum(axis=1))), faces // 2)


def _secret() -> bytes:
    import os

    return os.urandom(24)


def _of_obj(data: bytes) -> int:
    """Polygons count as the triangles that they are cut into; cutting takes the square of their corners."""
    import numpy as np

    points = triangles = cutting = 0
    for piece in _pieces(data):
        text = piece.replace(b"\r", b"\n").replace(b"\t", b" ")
        text = b"\n" + (_INDENTED.sub(b"\n", b"\n" + text) if b"\n " in text or text[:1] == b" " else text)
        view = np.frombuffer(text + b"\n\n", np.uint8)
        ends = np.flatnonzero(view[:-1] == 10)
        spaces = np.cumsum(view == 32, dtype=np.int32)
        words = np.diff(spaces[ends])
        first, second = view[ends[:-1] + 1], view[ends[:-1] + 2]
        points += int(np.count_nonzero((first == ord("v")) & (second == 32)))
        corners = words[(first == ord("f")) & (second == 32)].astype(np.int64)
        triangles += int(np.maximum(corners - 2, 0).sum())
        large = corners[corners > _LONG].astype(float)
        cutting += int((large * large).sum() / _CUT)
    return max(points, triangles // 2) + cutting


def _pieces(data: bytes) -> Iterator[bytes]:
    """A text, cut where lines end."""
    begin = 0
    while begin < len(data):
        end = len(data) if begin + _PIECE >= len(data) else data.find(b"\n", begin + _PIECE) + 1
        end = end or len(data)
        yield data[begin:end]
        begin = end


def _of_gmsh(numbers: bytes) -> int:
    """The number of nodes in gmsh 4 (blocks, nodes, lowest, highest) and gmsh 2 (nodes); binary ones have 64 bits."""
    first = numbers.split(b"\n")[1:2]
    words = first[0].split() if first else []
    if words and all(word.isdigit() for word in words):
        return int(words[1] if len(words) == 4 else words[0])
    binary = numbers[1:17]
    return int(struct.unpack("<2Q", binary)[1]) if len(binary) == 16 else 0
