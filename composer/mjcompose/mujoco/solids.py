"""Mass, inertia and volume of compiled bodies, compared with their geoms. Imports no MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.addresses import RUNS
from mjcompose.mujoco.attributes import Model

_ROUNDING = 1e-6
_ENDLESS = ("mjGEOM_PLANE", "mjGEOM_HFIELD")

_DIGITS = 7
SIGNS = [[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
"""The corners of a box, as shares of half its size."""


class Volume(Struct):
    """Between `least` and `most`, in m³; both are the same for a closed shape."""

    least: float
    most: float

    def __add__(self, other: Volume) -> Volume:
        return Volume(self.least + other.least, self.most + other.most)


def box_corners(data: Any, geom: int, *, center: Any, half: Any) -> Any:
    """Return the corners of a box around a geom in the world (m), (8, 3); `center` and `half` are in its frame."""
    import numpy as np

    return (center + half * np.array(SIGNS)) @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]


class Shapes:
    """The geoms of bodies at their places in the reference configuration."""

    def __init__(self, mujoco: Any, model: Model) -> None:
        import numpy as np

        self.mujoco, self.model, self.data = mujoco, model, mujoco.MjData(model)
        mujoco.mj_kinematics(model, self.data)
        endless = [int(getattr(mujoco.mjtGeom, name)) for name in _ENDLESS]
        self._of: dict[int, list[int]] = {}
        for geom in np.flatnonzero(~np.isin(model.geom_type, endless)).tolist():
            self._of.setdefault(int(model.body_weldid[model.geom_bodyid[geom]]), []).append(geom)

    def of(self, body: int) -> list[int]:
        """Return the geoms of a body and of bodies fixed to it, since exporters often split shapes and inertia."""
        return self._of.get(int(self.model.body_weldid[body]), [])

    def own(self, body: int) -> list[int]:
        """Return the geoms of the body alone."""
        return [each for each in self.of(body) if int(self.model.geom_bodyid[each]) == body]

    def corners(self, geoms: list[int]) -> Any:
        """Return the corners of the boxes around geoms, in the world frame (m), shape (8 n, 3)."""
        import numpy as np

        sides = (np.split(self.model.geom_aabb[geom], 2) for geom in geoms)
        boxes = zip(geoms, sides, strict=True)
        return np.concatenate([box_corners(self.data, geom, center=at, half=half) for geom, (at, half) in boxes])

    def reach(self, body: int) -> float:
        """Return the greatest distance of the body's geoms from its center of mass, in meters."""
        import numpy as np

        return float(np.linalg.norm(self.corners(self.of(body)) - self.data.xipos[body], axis=1).max())

    def volume(self, geoms: list[int]) -> Volume:
        """Return the volume of the largest group of geoms in m³, because visual geoms repeat collision geoms."""
        groups: dict[int, Volume] = {}
        for geom in geoms:
            group = int(self.model.geom_group[geom])
            groups[group] = groups.get(group, Volume(0.0, 0.0)) + volume(self.mujoco, self.model, geom)
        least = max((each.least for each in groups.values()), default=0.0)
        return Volume(least, max((each.most for each in groups.values()), default=0.0))


def faults(shapes: Shapes, body: int, gyration: float, outside: float) -> Iterator[str]:
    """Yield the impossible values of a body with geoms, in words. The limits are those of `InertiaImplausible`."""
    import numpy as np

    model = shapes.model
    mass, moments = float(model.body_mass[body]), sorted(map(float, model.body_inertia[body]))
    if moments[0] + moments[1] < moments[2] * (1 - _ROUNDING):
        shown = ", ".join(f"{each:.4g}" for each in moments)
        yield f"the two smaller of its principal moments {shown} kg·m² add up to less than the largest"
    corners, center = shapes.corners(shapes.of(body)), shapes.data.xipos[body]
    low, high = corners.min(axis=0), corners.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    # The distance to a box; inside of it all of these are negative.
    away = float(np.linalg.norm(np.maximum(np.maximum(low - center, center - high), 0.0)))
    if away > outside * diagonal + _ROUNDING:
        yield (f"its center of mass is {away:.4g} m outside the box around its geoms, which is {diagonal:.4g} m across")
    farthest = shapes.reach(body)
    radius = float(np.sqrt(moments[2] / mass))
    if radius > gyration * farthest * (1 + _ROUNDING):
        yield (
            f"its radius of gyration is {radius:.4g} m, and no point of its geoms is farther than {farthest:.4g} m"
            " from its center of mass"
        )


def volume(mujoco: Any, model: Any, geom: int) -> Volume:
    """Return the volume of a geom in m³. A mesh with holes is only known to have at most the volume of its box."""
    kinds, kind = mujoco.mjtGeom, int(model.geom_type[geom])
    a, b, c = map(float, model.geom_size[geom])
    exact = {
        kinds.mjGEOM_SPHERE: 4 / 3 * math.pi * a**3, kinds.mjGEOM_CAPSULE: math.pi * a * a * (2 * b + 4 / 3 * a),
        kinds.mjGEOM_CYLINDER: math.pi * a * a * 2 * b, kinds.mjGEOM_ELLIPSOID: 4 / 3 * math.pi * a * b * c,
        kinds.mjGEOM_BOX: 8 * a * b * c,
    }  # fmt: skip
    known, mesh = exact.get(kinds(kind)), int(model.geom_dataid[geom])
    if kind == int(kinds.mjGEOM_MESH) and mesh >= 0:
        known = _enclosed(model, mesh)
    box = 8 * math.prod(map(float, model.geom_aabb[geom][3:]))
    return Volume(0.0, box) if known is None else Volume(known, known)


def _enclosed(model: Any, mesh: int) -> float | None:
    """Return the volume inside a closed surface in m³, or None if it has holes."""
    import numpy as np

    of_points, of_faces = (RUNS["mesh"][size].rows(model, mesh) for size in ("nmeshvert", "nmeshface"))
    points = model.mesh_vert[of_points.start : of_points.stop].astype(float)
    faces = model.mesh_face[of_faces.start : of_faces.stop]
    # Files repeat a point for each face around it: the points count by where they are.
    size = float(np.ptp(points, axis=0).max(initial=0.0)) or 1.0
    _, same = np.unique(np.round(points / size, _DIGITS), axis=0, return_inverse=True)
    edges = same.reshape(-1)[faces][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    one, other = edges[edges[:, 0] != edges[:, 1]].T
    if not np.array_equal(np.sort(one * len(points) + other), np.sort(other * len(points) + one)):
        return None
    a, b, c = np.moveaxis(points[faces], 1, 0)
    inside = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    return inside if inside > 0 else None
