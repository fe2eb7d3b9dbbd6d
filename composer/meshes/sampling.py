"""Points on a surface, the same for the same seed on every machine."""

from __future__ import annotations

from typing import Any

import numpy


def on_surface(solid: Any, count: int, seed: int = 0) -> numpy.ndarray:
    """So many points, as many on each part of the surface as it is large."""
    return with_faces(solid, count, seed)[0]


def with_faces(solid: Any, count: int, seed: int = 0) -> tuple[numpy.ndarray, numpy.ndarray]:
    """The same, with the face that each is on."""
    random = numpy.random.Generator(numpy.random.PCG64(seed))
    ends = numpy.cumsum(solid.area_faces)
    faces = numpy.searchsorted(ends, random.random(count) * ends[-1])
    faces = numpy.minimum(faces, len(ends) - 1)
    corners = solid.triangles[faces]
    one, other = random.random((2, count, 1))
    over = one + other > 1
    one, other = numpy.where(over, 1 - one, one), numpy.where(over, 1 - other, other)
    first = corners[:, 0]
    return numpy.asarray(first + one * (corners[:, 1] - first) + other * (corners[:, 2] - first)), faces


def in_solid(shape: Any, count: int, seed: int = 0) -> numpy.ndarray:
    """Points in the box around a shape, as many as it takes for so many to be inside, or nearly; those inside."""
    random = numpy.random.Generator(numpy.random.PCG64(seed))
    low, high = shape.solid.bounds
    share = max(shape.volume / float(numpy.prod(high - low)), 0.05)
    points = low + random.random((int(count / share), 3)) * (high - low)
    return numpy.asarray(points[shape.contains(points)])
