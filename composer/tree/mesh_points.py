"""How many points the meshes of a model have: counted before MuJoCo looks for their hulls."""

from __future__ import annotations

import math
from collections.abc import Callable

from lxml.etree import XPath
from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.limits import advice, in_force
from composer.tree.classes import Classes, written
from composer.tree.effective import class_in_force
from composer.tree.file_points import file_points, most_file_points, most_points_by_size
from composer.tree.files import stem
from composer.tree.unit import Unit

_CODE = "limit-exceeded"
_WITHOUT_HULL = 10
"""How many points of a mesh without a hull cost as much as one of a mesh with a hull (MuJoCo 4.0: 1.5 and 18 us)."""
_MESHES, _WITHOUT_FILE = XPath("asset/mesh"), XPath("asset/mesh[not(@file)]")
_OF_DISTANCE = ("distance", "normal", "fromto")
_SQUARED = ("supersphere", "supertorus")
_MULTIPLIED = {"cone": 1, "wedge": 2, "plate": 2}
_GRIDS = ("grid", "box", "cylinder", "ellipsoid", "square", "disc")
"""Built-in meshes by what their `params` begin with; MuJoCo bounds those of other kinds by itself."""


def check_meshes(unit: Unit, attached: int, sink: Sink, *, opens_files: bool = True) -> bool:
    """Whether the meshes of a model, and `attached` points of those that it attaches, are no more than the limit.

    Files are read only if their sizes leave that open, and not at all unless `opens_files`: to ask for the sizes of
    sixty files takes four times as long as to parse the model that names them. Their points are counted only if a quick
    look leaves it open, too. What is too much is reported at the largest mesh.
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
    span = unit.origins.span(place, unit.file, _attribute(place))
    note = None
    if largest is not None and points[largest] < total:
        note = Note(f"{points[largest]} of them are those of this mesh, the largest")
    message = f"the meshes of the model have {total} points; {most} are allowed"
    sink.error(_CODE, message, span, notes=(note,) if note else (), help=advice("mesh-points", total))
    return False


def mesh_points(unit: Unit) -> int:
    """At least so many points that all meshes of a model have."""
    return sum(_counted(list(unit.root.iterfind("asset/mesh")), unit).values())


def _most(meshes: list[Node], unit: Unit, attached: int) -> float:
    """Return an upper bound of the points of all meshes and of those `attached`, from the sizes of files or a look."""
    by_size = [_points(each, unit, most_points_by_size) for each in meshes]
    if None not in by_size and (total := attached + sum(filter(None, by_size))) <= in_force().mesh_points:
        return total
    total, hulled = attached, _hulled(unit.root)
    for mesh, known in zip(meshes, by_size, strict=True):
        points = _points(mesh, unit, most_file_points) if known is None else known
        if points is None:
            return math.inf
        total += _weighed(points, mesh, hulled)
    return total


def _counted(meshes: list[Node], unit: Unit) -> dict[Node, int]:
    """Return what each counts. MuJoCo 4.0 makes a mesh once that several elements describe in the same words."""
    found: dict[Node, int] = {}
    hulled = _hulled(unit.root) if meshes else None
    seen = set()
    for mesh in meshes:
        words = tuple(sorted((str(name), str(value)) for name, value in mesh.items() if name != "name"))
        has_hull = _has_hull(mesh, hulled)
        if (words, has_hull) in seen and mesh.get("file"):
            continue
        seen.add((words, has_hull))
        # What is too much already needs no reading of the rest.
        points = None
        if sum(found.values()) > in_force().mesh_points:
            points = _points(mesh, unit, most_points_by_size)
        if points is None:
            points = _points(mesh, unit, file_points)
        found[mesh] = _weighed(points or 0, mesh, hulled)
    return found


def _weighed(points: int, mesh: Node, hulled: set[str] | None) -> int:
    return points if _has_hull(mesh, hulled) else -(-points // _WITHOUT_HULL)


def _has_hull(mesh: Node, hulled: set[str] | None) -> bool:
    return hulled is None or str(mesh.get("name") or stem(str(mesh.get("file")))) in hulled


def _hulled(root: Node) -> set[str] | None:
    """The names of the meshes that MuJoCo looks for hulls of; None where any may be among them.

    It does so for a geom that may collide, and for what asks for it by itself.
    """
    if (
        next(root.iterfind("contact/pair"), None) is not None
        or next(root.iter(*_OF_DISTANCE), None) is not None
    ):
        return None
    if any(each.get("inertia") == "convex" for each in root.iter("mesh")):
        return None
    if any(each.get("mesh") for each in root.iterfind("default//geom")):
        return None
    classes = Classes(root)
    return {
        str(each.get("mesh")) for each in root.iter("geom") if each.get("mesh") and _collides(each, classes)
    }


def _collides(geom: Node, classes: Classes) -> bool:
    known = None
    for name in ("contype", "conaffinity"):
        text = written(geom, name)
        if text is None:
            known = known or classes.get(class_in_force(geom).name)
            found = known.lookup("geom", name)
            text = None if found is None else found[0]
        if text is None or text.strip() != "0":
            return True
    return False


def _points(mesh: Node, unit: Unit, in_file: Callable[[Node, Unit], int | None]) -> int | None:
    if mesh.get("file"):
        return in_file(mesh, unit)
    if mesh.get("vertex"):
        return max(_words(mesh, "vertex") // 3, _words(mesh, "face") // 6)
    return _built_in(mesh)


def _built_in(mesh: Node) -> int:
    kind = str(mesh.get("builtin"))
    counts = [_count(word) for word in str(mesh.get("params") or "").split()[:3]] or [0]
    if kind in _SQUARED:
        return counts[0] ** 2
    if kind in _GRIDS:
        return math.prod(counts)
    return 2 * math.prod(counts[: _MULTIPLIED[kind]]) if kind in _MULTIPLIED else 0


def _count(word: str) -> int:
    """What is no number is reported elsewhere."""
    try:
        return max(0, int(float(word)))
    except (ValueError, OverflowError):
        return 0


def _words(mesh: Node, attribute: str) -> int:
    return len(str(mesh.get(attribute) or "").split())


def _attribute(mesh: Node) -> str | None:
    return next((each for each in ("file", "vertex", "params") if mesh.get(each)), None)
