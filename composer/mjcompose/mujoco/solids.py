"""Mass, inertia and volume of compiled bodies, compared with their geoms. Imports no MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.addresses import numbers_of

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

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


def box_corners(data: MjData, geom: int, *, center: Any, half: Any) -> Any:
    """Return the corners of a box around a geom in the world (m), (8, 3); `center` and `half` are in its frame."""
    import numpy as np

    return (center + half * np.array(SIGNS)) @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]


class WeldedGeoms:
    """The geoms of bodies that are fixed to each other. Their common values are computed once."""

    def __init__(self, mujoco: Any, model: MjModel, data: MjData, geoms: list[int]) -> None:
        self.mujoco = mujoco
        self.model = model
        self.data = data
        self.geoms = geoms

    @cached_property
    def corners(self) -> Any:
        """The corners of the boxes around the geoms, in the world frame (m), shape (8 n, 3)."""
        import numpy as np

        boxes = self.model.geom_aabb[self.geoms]
        center = boxes[:, None, :3]
        half = boxes[:, None, 3:]
        matrices = self.data.geom_xmat[self.geoms].reshape(-1, 3, 3)
        in_frame = center + half * np.array(SIGNS)
        in_world = in_frame @ matrices.transpose(0, 2, 1) + self.data.geom_xpos[self.geoms][:, None, :]
        return in_world.reshape(-1, 3)

    @cached_property
    def bounds(self) -> tuple[Any, Any]:
        """The least and the greatest coordinates of the corners, each of shape (3,)."""
        return self.corners.min(axis=0), self.corners.max(axis=0)

    @cached_property
    def outermost(self) -> Any:
        """A few corners that lie farthest out, shape (n, 3), at most 26."""
        import numpy as np

        directions = np.array([direction for direction in product((-1, 0, 1), repeat=3) if any(direction)])
        return self.corners[np.unique(np.argmax(self.corners @ directions.T, axis=0))]

    @cached_property
    def volume(self) -> Volume:
        """The volume of the largest group of geoms in m³, because visual geoms repeat collision geoms."""
        return largest_volume(self.mujoco, self.model, self.geoms)

    @cached_property
    def volume_of_boxes(self) -> float:
        """The sum of the volumes of the boxes around the geoms, in m³."""
        import numpy as np

        return float(8 * np.prod(self.model.geom_aabb[self.geoms][:, 3:], axis=1).sum())

    def reach(self, point: Any) -> float:
        """Return the greatest distance of the corners from a point of the world, in meters."""
        return _farthest(self.corners, point)

    def reaches(self, point: Any, distance: float) -> bool:
        """Return whether a corner is farther than `distance` (m) from a point of the world.

        The outermost corners answer for nearly all points, so a scene with many bodies does not compare each body with
        each corner.
        """
        return _farthest(self.outermost, point) > distance or self.reach(point) > distance


class Shapes:
    """The geoms of bodies at their places in the reference configuration."""

    def __init__(self, mujoco: Any, model: MjModel) -> None:
        import numpy as np

        self.mujoco = mujoco
        self.model = model
        self.data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, self.data)
        endless = [int(getattr(mujoco.mjtGeom, name)) for name in _ENDLESS]
        by_weld: dict[int, list[int]] = {}
        self._own: dict[int, list[int]] = {}
        for geom in np.flatnonzero(~np.isin(model.geom_type, endless)).tolist():
            body = int(model.geom_bodyid[geom])
            by_weld.setdefault(int(model.body_weldid[body]), []).append(geom)
            self._own.setdefault(body, []).append(geom)
        self._welded = {weld: WeldedGeoms(mujoco, model, self.data, geoms) for weld, geoms in by_weld.items()}

    def welded(self, body: int) -> WeldedGeoms | None:
        """Return the geoms of a body and of bodies fixed to it, since exporters often split shapes and inertia."""
        return self._welded.get(int(self.model.body_weldid[body]))

    def own(self, body: int) -> list[int]:
        """Return the geoms of the body alone."""
        return self._own.get(body, [])


def largest_volume(mujoco: Any, model: MjModel, geoms: list[int]) -> Volume:
    """Return the volume of the largest group of geoms in m³, because visual geoms repeat collision geoms."""
    groups: dict[int, Volume] = {}
    for geom in geoms:
        number = int(model.geom_group[geom])
        groups[number] = groups.get(number, Volume(0.0, 0.0)) + volume(mujoco, model, geom)
    least = max((group.least for group in groups.values()), default=0.0)
    most = max((group.most for group in groups.values()), default=0.0)
    return Volume(least, most)


def _farthest(points: Any, point: Any) -> float:
    import numpy as np

    return float(np.linalg.norm(points - point, axis=1).max())


def faults(shapes: Shapes, body: int, gyration: float, outside: float) -> Iterator[str]:
    """Yield the impossible values of a body with geoms, in words. The limits are those of `InertiaImplausible`."""
    import numpy as np

    geoms = shapes.welded(body)
    if geoms is None:
        return
    mass = float(shapes.model.body_mass[body])
    moments = sorted(map(float, shapes.model.body_inertia[body]))
    if moments[0] + moments[1] < moments[2] * (1 - _ROUNDING):
        shown = ", ".join(f"{moment:.4g}" for moment in moments)
        yield f"the two smaller of its principal moments {shown} kg·m² add up to less than the largest"
    center = shapes.data.xipos[body]
    low, high = geoms.bounds
    diagonal = float(np.linalg.norm(high - low))
    # The distance to a box; inside of it all of these are negative.
    away = float(np.linalg.norm(np.maximum(np.maximum(low - center, center - high), 0.0)))
    if away > outside * diagonal + _ROUNDING:
        yield (f"its center of mass is {away:.4g} m outside the box around its geoms, which is {diagonal:.4g} m across")
    radius = float(np.sqrt(moments[2] / mass))
    if not geoms.reaches(center, radius / (gyration * (1 + _ROUNDING))):
        yield (
            f"its radius of gyration is {radius:.4g} m, and no point of its geoms is farther than"
            f" {geoms.reach(center):.4g} m from its center of mass"
        )


def volume(mujoco: Any, model: MjModel, geom: int) -> Volume:
    """Return the volume of a geom in m³. A mesh with holes is only known to have at most the volume of its box."""
    kinds = mujoco.mjtGeom
    kind = int(model.geom_type[geom])
    a, b, c = map(float, model.geom_size[geom])
    exact = {
        kinds.mjGEOM_SPHERE: 4 / 3 * math.pi * a**3,
        kinds.mjGEOM_CAPSULE: math.pi * a * a * (2 * b + 4 / 3 * a),
        kinds.mjGEOM_CYLINDER: math.pi * a * a * 2 * b,
        kinds.mjGEOM_ELLIPSOID: 4 / 3 * math.pi * a * b * c,
        kinds.mjGEOM_BOX: 8 * a * b * c,
    }
    known = exact.get(kinds(kind))
    mesh = int(model.geom_dataid[geom])
    if kind == int(kinds.mjGEOM_MESH) and mesh >= 0:
        known = _enclosed(model, mesh)
    box = 8 * math.prod(map(float, model.geom_aabb[geom][3:]))
    return Volume(0.0, box) if known is None else Volume(known, known)


def _enclosed(model: MjModel, mesh: int) -> float | None:
    """Return the volume inside a closed surface in m³, or None if it has holes."""
    import numpy as np

    points = numbers_of(model, "mesh", "mesh_vert", mesh).astype(float)
    faces = numbers_of(model, "mesh", "mesh_face", mesh)
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
