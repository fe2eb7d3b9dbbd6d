"""The number of points in the meshes of a model, counted before MuJoCo processes them."""

from __future__ import annotations

import math
import os
import re
import struct
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any

from lxml.etree import XPath, _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.base.files import Memory, Refused, read_regular
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.tree.classes import Classes, class_in_force, written
from mjcompose.tree.files import join, stem, written_path
from mjcompose.tree.unit import Unit

_FACE = 50
"""The bytes of a face in a binary STL file."""
_HEAD = 84
"""The bytes of the head of a binary STL file."""
_PIECE = 1 << 24
_INDENTED = re.compile(rb"\n +")
_LONG = 1000
"""The number of corners above which cutting a polygon costs more than its points."""
_CUT = 4000
_SMALL = 1 << 15
"""An OBJ file of at most this many bytes has too few points to matter."""


def points_in(data: bytes, kind: str) -> int:
    r"""Return a lower bound for the points of a file, and for half of its faces; `kind` is the end of its name.

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
    """Return an upper bound of the points of a file of `size` bytes; None if the size does not suffice.

    >>> most_points(84 + 50 * 12, "stl"), most_points(1000, "obj")
    (36, 312)
    """
    if kind == "obj":  # a line of a point or a face has six bytes or more, a corner of a polygon two
        return size // 4 + (size // 2) ** 2 // _CUT if size <= _SMALL else None
    return 3 * (max(0, size - _HEAD) // _FACE) if kind == "stl" else None


def most_points_in(data: bytes, kind: str) -> int | None:
    r"""Return an upper bound of the points of a file, much faster than by counting; None if it has to count.

    >>> most_points_in(b"v 0 0 0\n" * 10_000, "obj"), most_points_in(b"f" + b" 1" * 20_000, "obj")
    (20000, None)
    """
    if kind != "obj" or len(data) <= _SMALL:
        return most_points(len(data), kind)
    # A line of this many corners, of two bytes or more, fills at least one of these windows.
    windows = range(0, len(data), _LONG)
    is_long = any(data.find(b"\n", begin, begin + _LONG) < 0 for begin in windows[:-1])
    # Two triangles weigh as much as a point; each has a corner of its own.
    return None if is_long else max(data.count(b"\n") + data.count(b"\r") + 1, len(data) // 4)


def _of_stl(data: bytes) -> int:
    """MuJoCo joins the corners that are equal."""
    import numpy as np

    faces = max(0, len(data) - _HEAD) // _FACE
    if not faces:
        return 0
    rows = np.frombuffer(data, np.uint8, faces * _FACE, _HEAD).reshape(faces, _FACE)
    corners = np.ascontiguousarray(rows[:, 12:48]).view("<u4").reshape(-1, 3).astype(np.uint64)
    # Odd numbers that nobody else knows: a file cannot be made so that other points seem equal.
    factors = np.frombuffer(os.urandom(24), np.uint64) | np.uint64(1)
    mixed = corners * factors
    mixed ^= mixed >> np.uint64(29)
    return max(len(np.unique((mixed * factors[::-1]).sum(axis=1))), faces // 2)


def _of_obj(data: bytes) -> int:
    """Polygons count as the triangles that they are cut into; cutting takes time in the square of the corners."""
    import numpy as np

    points = triangles = cutting = 0
    for piece in _pieces(data):
        text = piece.replace(b"\r", b"\n").replace(b"\t", b" ")
        text = b"\n" + (_INDENTED.sub(b"\n", b"\n" + text) if b"\n " in text or text[:1] == b" " else text)
        view = np.frombuffer(text + b"\n\n", np.uint8)
        ends = np.flatnonzero(view[:-1] == 10)
        spaces = np.cumsum(view == 32, dtype=np.int32)
        words = np.diff(spaces[ends])
        first = view[ends[:-1] + 1]
        second = view[ends[:-1] + 2]
        points += int(np.count_nonzero((first == ord("v")) & (second == 32)))
        corners = words[(first == ord("f")) & (second == 32)].astype(np.int64)
        triangles += int(np.maximum(corners - 2, 0).sum())
        large = corners[corners > _LONG].astype(float)
        cutting += int((large * large).sum() / _CUT)
    return max(points, triangles // 2) + cutting


def _pieces(data: bytes) -> Iterator[bytes]:
    begin = 0
    while begin < len(data):
        end = data.find(b"\n", begin + _PIECE) + 1 or len(data)
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


_MOST_KINDS = 16
"""Kinds of files of which something is remembered: models may make up others."""


def file_points(element: Node, unit: Unit) -> int:
    """Return a lower bound for the points of its file; 0 for a missing file, which is reported elsewhere."""
    return _in_file(element, unit, points_in) or 0


def _in_file(element: Node, unit: Unit, count: _Count) -> int | None:
    """Return the `count` for a file, without opening it in `most_points`."""
    path = written_path(unit.settings, element, str(element.get("file") or ""))
    # MuJoCo believes `content_type` rather than the name.
    told = str(element.get("content_type") or "").lower().rpartition("/")[2]
    kind = told or path.lower().rpartition(".")[2]
    held = unit.contents.get(path)
    try:
        if isinstance(held, bytes):
            return most_points(len(held), kind) if count is most_points else count(held, kind)
        real = unit.door.admit(str(held or join(str(unit.directory), path)))
        return most_points(os.stat(real).st_size, kind) if count is most_points else _memory(count, kind).ask(real)
    except (OSError, Refused):
        return 0


_Count = Callable[[Any, str], int | None]


@lru_cache(maxsize=_MOST_KINDS)
def _memory(count: _Count, kind: str) -> Memory[int | None]:
    return Memory(lambda path: count(read_regular(path), kind), lambda _: 0)


_WITHOUT_HULL = 10
"""How many points of a mesh without a hull cost as much as one of a mesh with a hull (MuJoCo 4.0: 1.5 and 18 us)."""
_MESHES = XPath("asset/mesh")
_WITHOUT_FILE = XPath("asset/mesh[not(@file)]")
_MULTIPLIED = {"cone": 1, "wedge": 2, "plate": 2}
_GRIDS = ("grid", "box", "cylinder", "ellipsoid", "square", "disc")
"""Built-in meshes by the beginning of their `params`; MuJoCo itself bounds the other kinds."""


def check_meshes(unit: Unit, attached: int, sink: Sink, *, opens_files: bool = True) -> bool:
    """Whether the meshes of a model, and `attached` points of models that it attaches, are within the limit.

    Files are read only if their sizes are not conclusive, and never unless `opens_files`: getting the sizes of sixty
    files takes four times as long as parsing the model that names them. Points are counted only if a quick look is not
    conclusive either. An excess is reported at the largest mesh.
    """
    most = in_force().mesh_points
    meshes: list[Node] = (_MESHES if opens_files else _WITHOUT_FILE)(unit.root)  # type: ignore[assignment]
    if _most(meshes, unit, attached) <= most:
        return True
    points = _counted(meshes, unit)
    total = attached + sum(points.values())
    if total <= most:
        return True
    largest = max(points, key=points.__getitem__, default=None)
    place = unit.root if largest is None else largest
    attribute = next((each for each in ("file", "vertex", "params") if place.get(each)), None)
    span = unit.origins.span(place, unit.file, attribute)
    notes: tuple[Note, ...] = ()
    if largest is not None and points[largest] < total:
        notes = (Note(f"this mesh, the largest, has {points[largest]} of them"),)
    message = f"the meshes of the model have {total} points; {most} are allowed"
    sink.error("limit-exceeded", message, span, notes=notes, help=advice("mesh-points", total))
    return False


def mesh_points(unit: Unit) -> int:
    """Return a lower bound for the points of all meshes of a model."""
    return sum(_counted(list(unit.root.iterfind("asset/mesh")), unit).values())


def _most(meshes: list[Node], unit: Unit, attached: int) -> float:
    """Return an upper bound of the points of all meshes and of `attached` points, from file sizes or a quick look."""
    by_size = [_points(mesh, unit, most_points) for mesh in meshes]
    if None not in by_size and (total := attached + sum(filter(None, by_size))) <= in_force().mesh_points:
        return total
    total = attached
    hulled = _hulled(unit.root)
    for mesh, known in zip(meshes, by_size, strict=True):
        points = _points(mesh, unit, most_points_in) if known is None else known
        if points is None:
            return math.inf
        total += _weighed(points, mesh, hulled)
    return total


def _counted(meshes: list[Node], unit: Unit) -> dict[Node, int]:
    """Return the count of each mesh. MuJoCo 4.0 makes a mesh that is described twice only once."""
    found: dict[Node, int] = {}
    hulled = _hulled(unit.root) if meshes else None
    seen = set()
    for mesh in meshes:
        words = tuple(sorted((str(name), str(value)) for name, value in mesh.items() if name != "name"))
        has_hull = _has_hull(mesh, hulled)
        if (words, has_hull) in seen and mesh.get("file"):
            continue
        seen.add((words, has_hull))
        # If these are too many already, the sizes of the other files are enough.
        is_over = sum(found.values()) > in_force().mesh_points
        points = _points(mesh, unit, most_points) if is_over else None
        points = _points(mesh, unit, points_in) if points is None else points
        found[mesh] = _weighed(points or 0, mesh, hulled)
    return found


def _weighed(points: int, mesh: Node, hulled: set[str] | None) -> int:
    return points if _has_hull(mesh, hulled) else -(-points // _WITHOUT_HULL)


def _has_hull(mesh: Node, hulled: set[str] | None) -> bool:
    return hulled is None or str(mesh.get("name") or stem(str(mesh.get("file")))) in hulled


def _hulled(root: Node) -> set[str] | None:
    """Return the names of the meshes whose hulls MuJoCo computes: those of geoms that may collide; None for all."""
    asks = (*root.iterfind("contact/pair"), *root.iter("distance", "normal", "fromto"))
    is_convex = any(each.get("inertia") == "convex" for each in root.iter("mesh"))
    if asks or is_convex or any(each.get("mesh") for each in root.iterfind("default//geom")):
        return None
    classes = Classes(root)
    return {str(each.get("mesh")) for each in root.iter("geom") if each.get("mesh") and _collides(each, classes)}


def _collides(geom: Node, classes: Classes) -> bool:
    given = {name: written(geom, name) for name in ("contype", "conaffinity")}
    around = class_in_force(geom).name if None in given.values() else None
    texts = [classes.effective(geom, around, name) if text is None else text for name, text in given.items()]
    return any(text is None or text.strip() != "0" for text in texts)


def _points(mesh: Node, unit: Unit, count: _Count) -> int | None:
    if mesh.get("file"):
        return _in_file(mesh, unit, count)
    if mesh.get("vertex"):
        vertices, faces = (len(str(mesh.get(name) or "").split()) for name in ("vertex", "face"))
        return max(vertices // 3, faces // 6)
    kind = str(mesh.get("builtin"))
    counts = [number(word) for word in str(mesh.get("params") or "").split()[:3]] or [0]
    if kind in ("supersphere", "supertorus"):
        return counts[0] ** 2
    if kind in _GRIDS:
        return math.prod(counts)
    return 2 * math.prod(counts[: _MULTIPLIED[kind]]) if kind in _MULTIPLIED else 0


def number(text: str | None, least: int = 0) -> int:
    """Return the number in a text, at least `least`. Anything else is reported elsewhere.

    >>> number("2e3"), number("many"), number(None, 1)
    (2000, 0, 1)
    """
    try:
        return max(least, int(float(text or 0)))
    except (ValueError, OverflowError):
        return least
