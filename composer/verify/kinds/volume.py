"""How much space a geom takes up, as far as its shape says."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from composer.dataclass import dataclass

_DIGITS = 7


@dataclass(frozen=True, slots=True)
class Volume:
    """Between `least` and `most`, in m³; both are the same for a closed shape."""

    least: float
    most: float

    def __add__(self, other: Volume) -> Volume:
        return Volume(self.least + other.least, self.most + other.most)


def volume(mujoco: Any, model: Any, geom: int) -> Volume:
    """Return the volume of a geom in m³. That of a mesh with holes is only known to be at most that of its box."""
    kinds, kind = mujoco.mjtGeom, int(model.geom_type[geom])
    a, b, c = map(float, model.geom_size[geom])
    exact = {
        int(kinds.mjGEOM_SPHERE): 4 / 3 * math.pi * a**3,
        int(kinds.mjGEOM_CAPSULE): math.pi * a * a * (2 * b + 4 / 3 * a),
        int(kinds.mjGEOM_CYLINDER): math.pi * a * a * 2 * b,
        int(kinds.mjGEOM_ELLIPSOID): 4 / 3 * math.pi * a * b * c,
        int(kinds.mjGEOM_BOX): 8 * a * b * c,
    }
    if kind in exact:
        return Volume(exact[kind], exact[kind])
    box = 8 * float(np.prod(model.geom_aabb[geom][3:]))
    mesh = int(model.geom_dataid[geom])
    enclosed = _enclosed(model, mesh) if kind == int(kinds.mjGEOM_MESH) and mesh >= 0 else None
    return Volume(0.0, box) if enclosed is None else Volume(enclosed, enclosed)


def _enclosed(model: Any, mesh: int) -> float | None:
    """Return the volume inside a closed surface in m³, or None if it has holes."""
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    points = model.mesh_vert[first : first + count].astype(float)
    start = int(model.mesh_faceadr[mesh])
    faces = model.mesh_face[start : start + int(model.mesh_facenum[mesh])]
    # Files repeat a point for each face around it: the points count by where they are.
    size = float(np.ptp(points, axis=0).max(initial=0.0)) or 1.0
    _, same = np.unique(np.round(points / size, _DIGITS), axis=0, return_inverse=True)
    faces = same.reshape(-1)[faces]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    there = edges[:, 0] * len(points) + edges[:, 1]
    back = edges[:, 1] * len(points) + edges[:, 0]
    if not np.array_equal(np.sort(there), np.sort(back)):
        return None
    corners = points[model.mesh_face[start : start + len(faces)]]
    inside = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)
    return inside if inside > 0 else None
