"""The exact distance of points from the triangles of a mesh, in bounded memory. Runs in the child process.

`trimesh.proximity.closest_point` compares a point with every triangle that meets the cube from the point to its nearest
vertex. The cube of a point far away contains most of a mesh, and all points are compared at once: 200,000 points and
8,000 triangles took 7 GB. Here the cube is a ball, which touches the mesh only near the closest triangle.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy

_PAIRS = 200_000
"""The number of pairs of a point and a triangle that are compared at once, about 100 MB."""
_POINTS = 4096
"""The number of points that are looked up at once."""
_SIZES = 12
"""The number of classes of size. The triangles of a class are half as large as in the class before."""


class TriangleSurface:
    """Triangles of shape (n, 3, 3), in meters."""

    def __init__(self, triangles: numpy.ndarray) -> None:
        self.triangles = numpy.asarray(triangles, dtype=float)
        self.centers = self.triangles.mean(axis=1)
        self.radii = numpy.linalg.norm(self.triangles - self.centers[:, None], axis=2).max(axis=1)

    def upper_bounds(self, points: numpy.ndarray) -> numpy.ndarray:
        """Return the distance of each point (m) from the nearest corner, which is at least that from the surface."""
        return numpy.asarray(self._corners.query(points)[0])

    def distances(self, points: numpy.ndarray) -> numpy.ndarray:
        """Return the distance of each point from the surface, in meters, shape (n,)."""
        points = numpy.asarray(points, dtype=float).reshape(-1, 3)
        return numpy.concatenate(
            [self._distances(points[start : start + _POINTS]) for start in range(0, len(points), _POINTS)]
            or [numpy.zeros(0)]
        )

    def _distances(self, points: numpy.ndarray) -> numpy.ndarray:
        distances = self.upper_bounds(points)
        for tree, members in self._by_size:
            largest = self.radii[members].max()
            for rows, numbers in _near(tree, points, distances + largest):
                triangles = members[numbers]
                from_centers = numpy.linalg.norm(points[rows] - self.centers[triangles], axis=1)
                is_candidate = from_centers - self.radii[triangles] <= distances[rows]
                rows = rows[is_candidate]
                triangles = triangles[is_candidate]
                numpy.minimum.at(distances, rows, _to_triangles(self.triangles[triangles], points[rows]))
        return distances

    @cached_property
    def _corners(self) -> Any:
        from scipy.spatial import cKDTree

        return cKDTree(self.triangles.reshape(-1, 3))

    @cached_property
    def _by_size(self) -> list[tuple[Any, numpy.ndarray]]:
        """A tree of the centers of each class of size, with the numbers of its triangles.

        One large triangle would otherwise make every small one a candidate.
        """
        from scipy.spatial import cKDTree

        largest = self.radii.max()
        shares = numpy.maximum(self.radii / largest, 2.0**-_SIZES) if largest > 0 else numpy.ones(len(self.radii))
        sizes = numpy.floor(-numpy.log2(shares)).astype(int)
        classes = [numpy.flatnonzero(sizes == size) for size in numpy.unique(sizes)]
        return [(cKDTree(self.centers[members]), members) for members in classes]


def _near(tree: Any, points: numpy.ndarray, distances: numpy.ndarray) -> Iterator[tuple[numpy.ndarray, numpy.ndarray]]:
    """Yield the pairs of a point and an entry of the tree within its distance, as two arrays of numbers."""
    counts = tree.query_ball_point(points, distances, return_length=True)
    batches = numpy.cumsum(counts) // _PAIRS
    for batch in numpy.unique(batches):
        rows = numpy.flatnonzero(batches == batch)
        entries = tree.query_ball_point(points[rows], distances[rows])
        total = int(counts[rows].sum())
        if total:
            numbers = numpy.fromiter((number for row in entries for number in row), dtype=int, count=total)
            yield numpy.repeat(rows, counts[rows]), numbers


def _to_triangles(triangles: numpy.ndarray, points: numpy.ndarray) -> numpy.ndarray:
    """Return the distance of each point from the triangle of the same row, in meters."""
    from trimesh.triangles import closest_point

    if not len(points):
        return numpy.zeros(0)
    return numpy.asarray(numpy.linalg.norm(closest_point(triangles, points) - points, axis=1))
