"""Rule `inertia-implausible`: masses and inertias fit the shapes of the bodies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope
from mjcompose.build.checks.rules.rule import Rule, chosen, excepted, listed
from mjcompose.language.forms.scalars import Expects, Items, Name, NotNegative, Positive, Range, Unit


class InertiaImplausible(Rule):
    """Masses and inertias could belong to the bodies, as far as their geoms show."""

    word: ClassVar = "inertia-implausible"
    kinds: ClassVar = ("body",)
    instead: ClassVar = {"bodies": "body"}

    body: Annotated[tuple[Annotated[str, Name("body", glob=True)], ...], Items(1, single=True)] = ()
    """the bodies; without it, all with a mass and geoms"""
    density: Annotated[Range, Expects("a list of 2 numbers", "[100, 9000]"), Unit("kg/m³")] | None = None
    """the least and the most, in kg/m³; without it, any"""
    gyration: Positive = 1.0
    """the largest radius of gyration, relative to the distance of the farthest point from the center of mass"""
    outside: NotNegative = 0.02
    """the allowed distance of the center of mass outside the box around the geoms, relative to the box's diagonal"""


RULE = InertiaImplausible
_ROUNDING = 1e-6
_ENDLESS = ("mjGEOM_PLANE", "mjGEOM_HFIELD")


def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
    """Report masses or inertias that do not fit the bodies."""
    bodies = chosen(scope, "body", settings)
    if isinstance(bodies, Fault):
        return [bodies]
    ignored = excepted(scope, ("body",), settings)
    if isinstance(ignored, Fault):
        return [ignored]
    shapes = _Shapes(scope)
    count, wrong = 0, []
    for body in list(scope.own("body")) if bodies is None else bodies:
        if body == 0 or ("body", body) in ignored or scope.model.body_mass[body] <= 0:
            continue
        geoms = shapes.of(body)
        if not geoms:
            continue
        count += 1
        name = scope.called("body", body)
        wrong += [f"{name}: {each}" for each in _faults(scope, shapes, body, geoms=geoms, settings=settings)]
    scope.found("bodies", count)
    scope.found("implausible", len(wrong))
    actual = f"{len(wrong)} fault{'s' * (len(wrong) > 1)} in {count} bodies"
    return listed(wrong, "masses and inertias that the geoms could have", actual)


class _Shapes:
    """The geoms of bodies at their places in the reference configuration."""

    def __init__(self, scope: Scope) -> None:
        import numpy as np

        mujoco, model = scope.mujoco, scope.model
        self.scope, self.data = scope, mujoco.MjData(model)
        mujoco.mj_kinematics(model, self.data)
        endless = [int(getattr(mujoco.mjtGeom, name)) for name in _ENDLESS]
        self._of: dict[int, list[int]] = {}
        for geom in np.flatnonzero(~np.isin(model.geom_type, endless)).tolist():
            self._of.setdefault(int(model.body_weldid[model.geom_bodyid[geom]]), []).append(geom)

    def of(self, body: int) -> list[int]:
        """Return the geoms of a body and of bodies fixed to it, since exporters often split shapes and inertia."""
        return self._of.get(int(self.scope.model.body_weldid[body]), [])

    def own(self, body: int) -> list[int]:
        """Return the geoms of the body alone."""
        return [each for each in self.of(body) if int(self.scope.model.geom_bodyid[each]) == body]

    def corners(self, geoms: list[int]) -> Any:
        """Return the corners of the boxes around geoms, in the world frame (m), shape (8 n, 3)."""
        import numpy as np

        model, data = self.scope.model, self.data
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        found = [
            (model.geom_aabb[geom][:3] + signs * model.geom_aabb[geom][3:])
            @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
            for geom in geoms
        ]  # fmt: skip
        return np.concatenate(found)


def _faults(scope: Scope, shapes: _Shapes, body: int, geoms: list[int], settings: Mapping[str, Any]) -> Iterator[str]:
    """Yield the impossible values of one body, in words."""
    import numpy as np

    model = scope.model
    mass, moments = float(model.body_mass[body]), sorted(map(float, model.body_inertia[body]))
    if moments[0] + moments[1] < moments[2] * (1 - _ROUNDING):
        shown = ", ".join(f"{each:.4g}" for each in moments)
        yield f"of its principal moments {shown} kg·m² the two smaller ones do not add up to the largest"
    corners, center = shapes.corners(geoms), shapes.data.xipos[body]
    low, high = corners.min(axis=0), corners.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    # The distance to a box; inside of it all of these are negative.
    outside = float(np.linalg.norm(np.maximum(np.maximum(low - center, center - high), 0.0)))
    if outside > settings["outside"] * diagonal + _ROUNDING:
        yield (
            f"its center of mass is {outside:.4g} m outside the box around its geoms, which is {diagonal:.4g} m across"
        )
    farthest = float(np.linalg.norm(corners - center, axis=1).max())
    gyration = float(np.sqrt(moments[2] / mass))
    if gyration > settings["gyration"] * farthest * (1 + _ROUNDING):
        yield (
            f"its radius of gyration is {gyration:.4g} m, and nothing of its geoms is farther than {farthest:.4g} m"
            " from its center of mass"
        )
    if settings["density"] is not None and (own := shapes.own(body)):
        yield from _density(scope, mass, own, bounds=settings["density"])


def _density(scope: Scope, mass: float, geoms: list[int], bounds: tuple[float, float]) -> Iterator[str]:
    """Yield that a body is too heavy or too light for its volume (kg/m³).

    The largest volume of a group of geoms counts, because visual and collision geoms are copies of the same body.
    """
    groups: dict[int, Volume] = {}
    for geom in geoms:
        group = int(scope.model.geom_group[geom])
        groups[group] = groups.get(group, Volume(0.0, 0.0)) + volume(scope.mujoco, scope.model, geom)
    least = max((each.least for each in groups.values()), default=0.0)
    most = max((each.most for each in groups.values()), default=0.0)
    low, high = bounds
    if most > 0 and mass / most > high:
        yield f"it weighs {mass:.4g} kg, which is {mass / most:.4g} kg/m³ of the volume of its geoms, above {high:g}"
    elif least > 0 and mass / least < low:
        yield f"it weighs {mass:.4g} kg, which is {mass / least:.4g} kg/m³ of the volume of its geoms, below {low:g}"


_DIGITS = 7


@dataclass(frozen=True, slots=True)
class Volume:
    """Between `least` and `most`, in m³; both are the same for a closed shape."""

    least: float
    most: float

    def __add__(self, other: Volume) -> Volume:
        return Volume(self.least + other.least, self.most + other.most)


def volume(mujoco: Any, model: Any, geom: int) -> Volume:
    """Return the volume of a geom in m³. A mesh with holes is only known to have at most the volume of its box."""
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
    box = 8 * math.prod(map(float, model.geom_aabb[geom][3:]))
    mesh = int(model.geom_dataid[geom])
    enclosed = _enclosed(model, mesh) if kind == int(kinds.mjGEOM_MESH) and mesh >= 0 else None
    return Volume(0.0, box) if enclosed is None else Volume(enclosed, enclosed)


def _enclosed(model: Any, mesh: int) -> float | None:
    """Return the volume inside a closed surface in m³, or None if it has holes."""
    import numpy as np

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
