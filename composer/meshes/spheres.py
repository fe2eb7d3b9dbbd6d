"""Balls that have all of a mesh's surface inside."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy

from composer.meshes.mesh import Mesh
from composer.meshes.sampling import on_surface
from composer.meshes.shape import Primitive

_POINTS = 4000
_ROUNDS = 20


def spheres(mesh: Mesh, wanted: Mapping[str, Any]) -> list[Primitive]:
    """So many balls, or fewer where one would be empty: each is the smallest around the surface nearest to it."""
    from trimesh.nsphere import minimum_nsphere

    points = numpy.vstack((mesh.vertices, on_surface(mesh.solid, _POINTS, wanted["seed"])))
    centres = _apart(points, wanted["count"])
    nearest = numpy.zeros(len(points), dtype=int)
    for _ in range(_ROUNDS):
        nearest = _nearest(points, centres)
        centres = numpy.array([points[nearest == each].mean(axis=0) for each in numpy.unique(nearest)])
    found = []
    for each in numpy.unique(nearest):
        own = points[nearest == each]
        centre = numpy.asarray(minimum_nsphere(own)[0]) if len(own) > 4 else own.mean(axis=0)
        radius = float(numpy.linalg.norm(own - centre, axis=1).max())
        found.append(Primitive("sphere", (radius,), centre, turn=numpy.eye(3)))
    return found


def _apart(points: numpy.ndarray, count: int) -> numpy.ndarray:
    """Points far from one another: each is the one that is farthest from those before it."""
    chosen = [int(numpy.linalg.norm(points - points.mean(axis=0), axis=1).argmax())]
    away = numpy.full(len(points), numpy.inf)
    for _ in range(count - 1):
        away = numpy.minimum(away, numpy.linalg.norm(points - points[chosen[-1]], axis=1))
        chosen.append(int(away.argmax()))
    return points[chosen].copy()


def _nearest(points: numpy.ndarray, centres: numpy.ndarray) -> numpy.ndarray:
    from scipy.spatial import cKDTree

    return numpy.asarray(cKDTree(centres).query(points)[1])
