"""How far shapes are from the mesh that they stand for.

`beyond` is how far the shapes reach out of the mesh at most, `short` how far the mesh reaches out of the shapes; the
greater of the two is the Hausdorff distance of the two solids. `uncovered` is the share of the mesh's surface that is
outside of all shapes, `volume` that of all shapes together by that of the mesh. All of it is measured at points that a
fixed seed chooses, and at all vertices.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy

from composer.meshes.mesh import Mesh
from composer.meshes.sampling import in_solid, on_surface, with_faces
from composer.meshes.shape import Shape, rounded

_POINTS = 4000
_VERTICES = 20_000
_NEAR = 1e-4
"""By the size of the mesh: a surface that is no farther outside counts as covered."""
_BEHIND = 2e-3
"""By the size of the mesh: how far behind the surface of a piece another piece begins that it was cut from."""
_AT_ONCE = 64


def measured(mesh: Mesh, shapes: Sequence[Shape]) -> dict[str, Any]:
    """The errors of shapes, in metres and shares; `volume` is None for a mesh that is open."""
    surface = on_surface(mesh.solid, _POINTS)
    corners = _some(mesh.vertices)
    away = _outside(shapes, numpy.vstack((surface, corners)))
    beyond, points = _beyond(mesh, shapes)
    return {
        **_distances(beyond, float(away.max())),
        "uncovered": rounded(float((away[: len(surface)] > _NEAR * mesh.size).mean())),
        "volume": _volume(shapes) / abs(float(mesh.solid.volume)) if mesh.is_closed else None,
        "samples": len(surface) + len(corners) + points,
    }


def measure_surfaces(mesh: Mesh, other: Mesh) -> dict[str, Any]:
    """The same of a mesh that takes the place of another: how far each surface is from the other."""
    sides = []
    for one, two in ((other, mesh), (mesh, other)):
        points = numpy.vstack((on_surface(one.solid, _POINTS), _some(one.vertices)))
        sides.append((float(_to_surface(two, points).max()), len(points)))
    closed = mesh.is_closed and other.is_closed
    return {
        **_distances(sides[0][0], sides[1][0]),
        "uncovered": None,
        "volume": abs(float(other.solid.volume)) / abs(float(mesh.solid.volume)) if closed else None,
        "samples": sides[0][1] + sides[1][1],
    }


def _distances(beyond: float, short: float) -> dict[str, float]:
    # A nanometre is less than the arithmetic can tell.
    beyond, short = round(beyond, 9), round(short, 9)
    return {"hausdorff": max(beyond, short), "beyond": beyond, "short": short}


def _some(vertices: numpy.ndarray) -> numpy.ndarray:
    """All of them, or of very many every so many."""
    return vertices[:: max(1, -(-len(vertices) // _VERTICES))]


def _outside(shapes: Sequence[Shape], points: numpy.ndarray) -> numpy.ndarray:
    """How far points are from the nearest shape; zero where they are in one."""
    found = numpy.zeros(len(points))
    rest = numpy.arange(len(points))
    for shape in shapes:
        rest = rest[~shape.contains(points[rest])]
        if not len(rest):
            return found
    # A shape is convex: the nearest point of one that a point is outside of is on its surface.
    found[rest] = numpy.min([shape.distance(points[rest]) for shape in shapes], axis=0)
    return found


def _beyond(mesh: Mesh, shapes: Sequence[Shape]) -> tuple[float, int]:
    """How far the outer surface of the shapes is from a mesh that it is outside of, and at how many points."""
    each = max(_POINTS // len(shapes), 200)
    outer = []
    for number, shape in enumerate(shapes):
        points, normals = _with_normals(shape.solid, each)
        # Pieces that were cut apart do not quite touch: a point is inside if there is another piece behind it.
        behind = points + _BEHIND * mesh.size * normals
        for other in (*shapes[:number], *shapes[number + 1 :]):
            free = ~(other.contains(behind) | other.contains(points))
            points, behind = points[free], behind[free]
        outer.append(points)
    points = numpy.vstack(outer)
    if not len(points):
        return 0.0, 0
    away = _to_surface(mesh, points)
    order = numpy.argsort(-away, kind="stable")
    for start in range(0, len(order), _AT_ONCE):
        some = order[start : start + _AT_ONCE]
        out = _winding(mesh, points[some]) < 0.5
        if out.any():
            return float(away[some[out.argmax()]]), len(points)
    return 0.0, len(points)


def _with_normals(solid: Any, count: int) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Points on a surface and all its corners, with the directions out of it."""
    points, faces = with_faces(solid, count)
    corners = _some(solid.triangles.reshape(-1, 3))
    every = _some(numpy.repeat(numpy.arange(len(solid.faces)), 3))
    return numpy.vstack((points, corners)), solid.face_normals[numpy.concatenate((faces, every))]


def _to_surface(mesh: Mesh, points: numpy.ndarray) -> numpy.ndarray:
    from trimesh.proximity import closest_point

    return numpy.asarray(closest_point(mesh.solid, points)[1])


def _winding(mesh: Mesh, points: numpy.ndarray) -> numpy.ndarray:
    """How often the surface goes around points: one inside, zero outside, between the two near a hole."""
    found = numpy.empty(len(points))
    for number, point in enumerate(points):
        one, two, three = (mesh.solid.triangles[:, at] - point for at in range(3))
        lengths = [numpy.linalg.norm(side, axis=1) for side in (one, two, three)]
        triple = (one * numpy.cross(two, three)).sum(axis=1)
        below = lengths[0] * lengths[1] * lengths[2]
        below += (one * two).sum(axis=1) * lengths[2]
        below += (two * three).sum(axis=1) * lengths[0] + (three * one).sum(axis=1) * lengths[1]
        found[number] = numpy.arctan2(triple, below).sum() / (2 * numpy.pi)
    # A mesh may be inside out as a whole.
    return numpy.abs(found)


def _volume(shapes: Sequence[Shape]) -> float:
    """Of all shapes together: what several have is counted once."""
    if len(shapes) == 1:
        return shapes[0].volume
    whole = 0.0
    for shape in shapes:
        points = in_solid(shape, _POINTS)
        shared = sum(other.contains(points).astype(float) for other in shapes)
        whole += shape.volume * float((1 / numpy.maximum(shared, 1)).mean()) if len(points) else shape.volume
    return whole
