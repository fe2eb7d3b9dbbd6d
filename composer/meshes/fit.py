"""One primitive around a mesh: the smallest that has all of it inside, as far as the search goes."""

from __future__ import annotations

import numpy

from composer.meshes.mesh import Mesh
from composer.meshes.shape import Primitive, hull_of

PRIMITIVES = ("box", "sphere", "capsule", "cylinder")
BEST = "best"
_LEAST = 1e-4
"""The half length of a capsule that would be a ball, by its radius: MuJoCo wants it to be greater than zero."""


def fit(mesh: Mesh, wanted: str) -> Primitive:
    """The primitive of that type, or with `best` the one of the least volume."""
    points = hull_of(mesh.vertices).vertices
    types = PRIMITIVES if wanted == BEST else (wanted,)
    return min((_fitted(each, points) for each in types), key=lambda each: each.volume)


def _fitted(type: str, points: numpy.ndarray) -> Primitive:
    if type == "sphere":
        centre, radius = _ball(points)
        return Primitive("sphere", (radius,), centre, turn=numpy.eye(3))
    turn, low, high = _box(points)
    if type == "box":
        return Primitive("box", tuple((high - low) / 2), turn @ ((low + high) / 2), turn=turn)
    found = []
    for axes in ((1, 2, 0), (2, 0, 1), (0, 1, 2)):
        turned = turn[:, axes]
        inner = points @ turned
        centre, radius = _ball(inner[:, :2])
        apart = numpy.linalg.norm(inner[:, :2] - centre, axis=1)
        along = inner[:, 2]
        if type == "capsule":
            spare = numpy.sqrt(numpy.maximum(radius**2 - apart**2, 0))
            bottom, top = (along + spare).min(), (along - spare).max()
            if top < bottom:
                bottom = top = (bottom + top) / 2
            half = max((top - bottom) / 2, _LEAST * radius)
        else:
            bottom, top = along.min(), along.max()
            half = (top - bottom) / 2
        pos = turned @ numpy.array([*centre, (bottom + top) / 2])
        found.append(Primitive(type, (float(radius), float(half)), pos, turn=turned))
    return min(found, key=lambda each: each.volume)


def _box(points: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
    """The axes of the smallest box around points, as the columns of a rotation, and its two corners along these."""
    from trimesh.bounds import oriented_bounds

    into, _ = oriented_bounds(points)
    turn = into[:3, :3].T
    if numpy.linalg.det(turn) < 0:
        turn = turn * numpy.array([1, 1, -1])
    inner = points @ turn
    return turn, inner.min(axis=0), inner.max(axis=0)


def _ball(points: numpy.ndarray) -> tuple[numpy.ndarray, float]:
    """The smallest ball, or circle, around points."""
    from trimesh.nsphere import minimum_nsphere

    centre: numpy.ndarray = numpy.array(minimum_nsphere(points)[0], numpy.float64)
    return centre, float(numpy.linalg.norm(points - centre, axis=1).max())
