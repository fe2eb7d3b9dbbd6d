"""Convex shapes in the frame of a mesh: what is inside, how far away a point is, and points on the surface."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy

from composer.dataclass import dataclass

_ON = 1e-9
_FINE = 4
"""How often the triangles of a ball are divided: its surface is off by 0.2 % of the radius then."""


def rounded(number: float) -> float:
    """A number as MuJoCo keeps it in a mesh, which has seven digits; the same on all machines that agree so far."""
    return float(f"{number:.7g}") + 0.0


@dataclass(frozen=True)
class Hull:
    """The convex hull of its vertices."""

    vertices: numpy.ndarray
    faces: numpy.ndarray

    def to_data(self) -> dict[str, Any]:
        return {
            "type": "mesh",
            "vertices": [[rounded(each) for each in vertex] for vertex in self.vertices],
            "faces": self.faces.tolist(),
        }

    @cached_property
    def solid(self) -> Any:
        import trimesh

        return trimesh.Trimesh(self.vertices, self.faces, process=False)

    @cached_property
    def _planes(self) -> numpy.ndarray:
        return numpy.column_stack(
            (self.solid.face_normals, -(self.solid.face_normals * self.solid.triangles[:, 0]).sum(axis=1))
        )

    @property
    def volume(self) -> float:
        return abs(float(self.solid.volume))

    def contains(self, points: numpy.ndarray) -> numpy.ndarray:
        above = points @ self._planes[:, :3].T + self._planes[:, 3]
        return numpy.asarray(above.max(axis=1, initial=-numpy.inf) <= _ON)

    def distance(self, points: numpy.ndarray) -> numpy.ndarray:
        """Of points that are outside."""
        from trimesh.proximity import closest_point

        return numpy.asarray(closest_point(self.solid, points)[1])


@dataclass(frozen=True)
class Primitive:
    """A box, sphere, capsule or cylinder; `size` is that of MuJoCo's geom, `turn` a matrix."""

    type: str
    size: tuple[float, ...]
    pos: numpy.ndarray
    turn: numpy.ndarray

    def to_data(self) -> dict[str, Any]:
        from trimesh.transformations import quaternion_from_matrix

        whole = numpy.eye(4)
        whole[:3, :3] = self.turn
        quat = quaternion_from_matrix(whole)
        quat = -quat if quat[0] < 0 else quat
        return {
            "type": self.type,
            "size": [rounded(each) for each in self.size],
            "pos": [rounded(each) for each in self.pos],
            "quat": [rounded(each) for each in quat],
        }

    @cached_property
    def solid(self) -> Any:
        import trimesh

        if self.type == "box":
            made = trimesh.creation.box(extents=[2 * each for each in self.size])
        elif self.type == "sphere":
            made = trimesh.creation.icosphere(subdivisions=_FINE, radius=self.size[0])
        elif self.type == "capsule":
            radius, half = self.size
            made = trimesh.creation.capsule(height=2 * half, radius=radius, count=[64, 64])
            made.apply_translation([0, 0, -made.bounds.mean(axis=0)[2]])
        else:
            made = trimesh.creation.cylinder(radius=self.size[0], height=2 * self.size[1], sections=64)
        whole = numpy.eye(4)
        whole[:3, :3], whole[:3, 3] = self.turn, self.pos
        made.apply_transform(whole)
        return made

    @property
    def volume(self) -> float:
        first = self.size[0]
        if self.type == "box":
            return float(8 * numpy.prod(self.size))
        ball, tube = 4 / 3 * numpy.pi * first**3, 2 * numpy.pi * first**2
        if self.type == "sphere":
            return float(ball)
        return float(tube * self.size[1] + (ball if self.type == "capsule" else 0))

    def contains(self, points: numpy.ndarray) -> numpy.ndarray:
        return numpy.asarray(self.distance(points) <= _ON)

    def distance(self, points: numpy.ndarray) -> numpy.ndarray:
        """Zero inside."""
        inner = (points - self.pos) @ self.turn
        if self.type == "box":
            beyond = numpy.abs(inner) - numpy.array(self.size)
        elif self.type == "cylinder":
            radial = numpy.linalg.norm(inner[:, :2], axis=1) - self.size[0]
            beyond = numpy.column_stack((radial, numpy.abs(inner[:, 2]) - self.size[1]))
        else:
            half = self.size[1] if self.type == "capsule" else 0.0
            along = numpy.clip(inner[:, 2], -half, half)
            inner = inner - numpy.outer(along, [0, 0, 1])
            beyond = (numpy.linalg.norm(inner, axis=1) - self.size[0])[:, None]
        return numpy.asarray(numpy.linalg.norm(numpy.maximum(beyond, 0), axis=1))


Shape = Hull | Primitive


def hull_of(vertices: numpy.ndarray, most: int | None = None) -> Hull:
    """The convex hull of points, with at most so many vertices."""
    from scipy.spatial import ConvexHull

    # Qhull starts with a tetrahedron and stops after so many more vertices; so MuJoCo has it for `maxhullvert`.
    found = ConvexHull(vertices, qhull_options="Qt" if most is None else f"Qt TA{most - 4}")
    kept = numpy.unique(found.simplices)
    faces = numpy.searchsorted(kept, found.simplices)
    corners = vertices[kept]
    # Qhull turns its triangles either way.
    normals = numpy.cross(
        corners[faces[:, 1]] - corners[faces[:, 0]], corners[faces[:, 2]] - corners[faces[:, 0]]
    )
    wrong = (normals * found.equations[:, :3]).sum(axis=1) < 0
    faces[wrong] = faces[wrong][:, ::-1]
    return Hull(corners, faces)
