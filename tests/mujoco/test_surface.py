from __future__ import annotations

import tracemalloc
from typing import Any

import numpy
import pytest
from mjcompose.mujoco import fit
from mjcompose.mujoco.surface import TriangleSurface

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("scipy")
pytest.importorskip("rtree")


def bumpy(subdivisions: int) -> Any:
    """A ball with bumps, which is not convex."""
    solid = trimesh.creation.icosphere(subdivisions=subdivisions)
    solid.vertices *= 1 + 0.2 * numpy.sin(5 * solid.vertices[:, :1])
    return solid


def with_a_large_triangle() -> Any:
    solid = bumpy(2)
    corner = len(solid.vertices)
    vertices = numpy.vstack((solid.vertices, [[-50, -50, -2], [50, -50, -2], [0, 80, -2.5]]))
    faces = numpy.vstack((solid.faces, [[corner, corner + 1, corner + 2]]))
    return trimesh.Trimesh(vertices, faces, process=False)


@pytest.mark.parametrize("solid", [bumpy(2), with_a_large_triangle(), trimesh.creation.box(extents=(1, 2, 30))])
def test_distances_are_those_of_trimesh(solid: Any) -> None:
    points = numpy.random.default_rng(0).normal(size=(300, 3)) * [[3, 3, 8]]
    points = numpy.vstack((points, solid.vertices[:20], solid.triangles_center[:20]))
    expected = trimesh.proximity.closest_point(solid, points)[1]
    assert numpy.allclose(TriangleSurface(solid.triangles).distances(points), expected, atol=1e-12)


def test_no_points_and_triangles_without_size() -> None:
    surface = TriangleSurface(numpy.ones((2, 3, 3)))
    assert surface.distances(numpy.zeros((0, 3))).shape == (0,)
    assert surface.distances([[1, 1, 1], [2, 1, 1]]).tolist() == [0, 1]


def test_points_far_from_a_fine_mesh_take_little_memory() -> None:
    points = 4 * trimesh.creation.icosphere(subdivisions=4).vertices
    surface = TriangleSurface(bumpy(5).triangles)
    tracemalloc.start()
    try:
        surface.distances(points)
        assert tracemalloc.get_traced_memory()[1] < 150e6
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_ball_around_many_points_has_all_of_them_inside_in_little_memory(dimensions: int) -> None:
    points = numpy.random.default_rng(1).normal(size=(9_000, dimensions))
    points /= numpy.linalg.norm(points, axis=1)[:, None]
    points *= 1 + 1e-3 * numpy.random.default_rng(2).random((len(points), 1))
    tracemalloc.start()
    try:
        center, radius = fit._ball(points)
        assert tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()
    assert (numpy.linalg.norm(points - center, axis=1) <= radius + 1e-12).all()
    assert 1 <= radius <= 1.01
