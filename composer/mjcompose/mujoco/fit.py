"""Shapes that replace a mesh: fitted, simplified and measured, in the child process.

`beyond` is the largest distance by which the shapes extend beyond the mesh, and `short` by which the mesh extends
beyond the shapes; the larger of the two is the Hausdorff distance of the two solids. `uncovered` is the share of the
mesh's surface that is outside all shapes, and `volume` is the volume of all shapes together divided by the mesh's. All
of these are measured at points that a fixed seed chooses, and at all vertices.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib import metadata
from typing import Any

import numpy

from mjcompose.mujoco import shapes as geometry
from mjcompose.mujoco.shapes import Mesh, MeshHull, Primitive, Shape, UnusableError, hull_of, on_surface, rounded
from mjcompose.mujoco.surface import TriangleSurface

_POINTS = 4000
_ROUNDS = 20


def spheres(mesh: Mesh, wanted: Mapping[str, Any]) -> list[Primitive]:
    """Return this number of balls, or fewer if one would be empty, each around its part of the surface."""
    from scipy.spatial import cKDTree

    points = numpy.vstack((mesh.vertices, on_surface(mesh.solid, _POINTS, wanted["seed"])))
    centers = _apart(points, wanted["count"])
    nearest = numpy.zeros(len(points), dtype=int)
    for _ in range(_ROUNDS):
        nearest = numpy.asarray(cKDTree(centers).query(points)[1])
        centers = numpy.array([points[nearest == each].mean(axis=0) for each in numpy.unique(nearest)])
    own = (points[nearest == each] for each in numpy.unique(nearest))
    balls = (_ball(each, each.mean(axis=0) if len(each) <= 4 else None) for each in own)
    return [Primitive("sphere", (radius,), center, turn=numpy.eye(3)) for center, radius in balls]


def _apart(points: numpy.ndarray, count: int) -> numpy.ndarray:
    """Return points far from one another: each one is the farthest point from the earlier points."""
    chosen = [int(numpy.linalg.norm(points - points.mean(axis=0), axis=1).argmax())]
    away = numpy.full(len(points), numpy.inf)
    for _ in range(count - 1):
        away = numpy.minimum(away, numpy.linalg.norm(points - points[chosen[-1]], axis=1))
        chosen.append(int(away.argmax()))
    return points[chosen].copy()


PRIMITIVES = ("box", "sphere", "capsule", "cylinder")
BEST = "best"
_LEAST = 1e-4
"""The half length of a capsule that would be a ball, by its radius: in MuJoCo it is greater than zero."""


def fit(mesh: Mesh, wanted: str) -> Primitive:
    """Return the primitive of that type, or with `best`, the primitive of the smallest volume."""
    points = hull_of(mesh.vertices).vertices
    types = PRIMITIVES if wanted == BEST else (wanted,)
    return min((_fitted(each, points) for each in types), key=lambda each: each.volume)


def _fitted(type: str, points: numpy.ndarray) -> Primitive:
    if type == "sphere":
        center, radius = _ball(points)
        return Primitive("sphere", (radius,), center, turn=numpy.eye(3))
    turn, low, high = _box(points)
    if type == "box":
        return Primitive("box", tuple((high - low) / 2), turn @ ((low + high) / 2), turn=turn)
    found = []
    for axes in ((1, 2, 0), (2, 0, 1), (0, 1, 2)):
        turned = turn[:, axes]
        flat = (points @ turned)[:, :2]
        along = (points @ turned)[:, 2]
        center, radius = _ball(flat)
        if type == "capsule":
            spare = numpy.sqrt(numpy.maximum(radius**2 - numpy.linalg.norm(flat - center, axis=1) ** 2, 0))
            bottom = (along + spare).min()
            top = (along - spare).max()
            if top < bottom:
                bottom = top = (bottom + top) / 2
            half = max((top - bottom) / 2, _LEAST * radius)
        else:
            bottom = along.min()
            top = along.max()
            half = (top - bottom) / 2
        pos = turned @ numpy.array([*center, (bottom + top) / 2])
        found.append(Primitive(type, (float(radius), float(half)), pos, turn=turned))
    return min(found, key=lambda each: each.volume)


def _box(points: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
    """The axes of the smallest box around points, as the columns of a rotation, and its corners along these axes."""
    from trimesh.bounds import oriented_bounds

    into, _ = oriented_bounds(points)
    turn = into[:3, :3].T
    if numpy.linalg.det(turn) < 0:
        turn = turn * numpy.array([1, 1, -1])
    inner = points @ turn
    return turn, inner.min(axis=0), inner.max(axis=0)


_BALL_AT_ONCE = 2000
"""The number of points whose smallest ball is computed at once. `minimum_nsphere` compares each point with each other,
which takes up to 4 GB for 20,000 points."""
_BALL_FIRST = 500
_BALL_MORE = 50
_INSIDE = 1e-9
"""By the radius: a point that is at most this far outside counts as inside."""


def _ball(points: numpy.ndarray, around: numpy.ndarray | None = None) -> tuple[numpy.ndarray, float]:
    """Return center and radius of the smallest ball, or of the ball around a point."""
    center = _center(points) if around is None else around
    return center, float(numpy.linalg.norm(points - center, axis=1).max())


def _center(points: numpy.ndarray) -> numpy.ndarray:
    """Return the center of the smallest ball around points.

    The smallest ball around some of many points is the smallest ball around all of them if no point is outside.
    """
    if len(points) <= _BALL_AT_ONCE:
        return _center_at_once(points)
    from_mean = numpy.linalg.norm(points - points.mean(axis=0), axis=1)
    chosen = numpy.argsort(-from_mean, kind="stable")[:_BALL_FIRST]
    while True:
        center = _center_at_once(points[chosen])
        distances = numpy.linalg.norm(points - center, axis=1)
        is_outside = distances > distances[chosen].max() * (1 + _INSIDE)
        if not is_outside.any():
            return center
        farthest = numpy.argsort(-distances, kind="stable")[:_BALL_MORE]
        chosen = numpy.unique(numpy.concatenate((chosen, farthest)))


def _center_at_once(points: numpy.ndarray) -> numpy.ndarray:
    from trimesh.nsphere import minimum_nsphere

    return numpy.array(minimum_nsphere(points)[0], numpy.float64)


def decompose(mesh: Mesh, wanted: Mapping[str, Any]) -> list[MeshHull]:
    """The pieces, in CoACD's order, which a seed decides."""
    import coacd
    from scipy.spatial import QhullError

    coacd.set_log_level("error")
    found = coacd.run_coacd(
        coacd.Mesh(mesh.vertices, mesh.faces),
        threshold=wanted["threshold"],
        max_convex_hull=-1 if wanted["parts"] is None else wanted["parts"],
        seed=wanted["seed"],
        decimate=True,
        max_ch_vertex=wanted["vertices"],
    )
    pieces = []
    for vertices, _ in found:
        with suppress(QhullError):  # a sliver without volume, which touches nothing that its neighbors do not
            pieces.append(hull_of(vertices))
    if not pieces:
        raise UnusableError("CoACD finds no piece of it")
    return pieces


_BOLDNESS = (2, 3, 4, 5, 6, 7)
"""How much an edge may be off to be taken away, by fast-simplification's measure: the careful ones first."""
_PASSES = 3


def simplify(mesh: Mesh, faces: int) -> Mesh:
    """The mesh with at most `faces` faces; the mesh itself if it has no more. Raises UnusableError."""
    if len(mesh.faces) <= faces:
        return mesh
    fewest = len(mesh.faces)
    for found in _tries(mesh, faces):
        # A closed surface that has a hole now was torn.
        if len(found.faces) and (found.is_closed or not mesh.is_closed):
            fewest = min(fewest, len(found.faces))
            if 4 <= len(found.faces) <= faces:
                return found
    raise UnusableError(f"it cannot be simplified to {faces} faces without being torn: {fewest} is the fewest")


def _tries(mesh: Mesh, faces: int) -> Iterator[Mesh]:
    import fast_simplification
    import trimesh

    for boldness in _BOLDNESS:
        found = mesh
        for _ in range(_PASSES):
            if len(found.faces) <= faces:
                break
            points, triangles = fast_simplification.simplify(
                found.vertices.astype(numpy.float32), found.faces.astype(numpy.int32), target_count=faces, agg=boldness
            )[:2]
            solid = trimesh.Trimesh(points, triangles, process=True)
            solid.update_faces(solid.nondegenerate_faces())
            solid.remove_unreferenced_vertices()
            found = Mesh(numpy.asarray(solid.vertices), numpy.asarray(solid.faces), solid)
            yield found


_VERTICES = 20_000
_NEAR = 1e-4
"""By the size of the mesh: a surface that is at most this far outside counts as covered."""
_BEHIND = 2e-3
"""By the size of the mesh: how far behind the surface of a piece another piece begins that it was cut from."""
_AT_ONCE = 64


def measured(mesh: Mesh, shapes: Sequence[Shape]) -> dict[str, Any]:
    """The errors of shapes, in meters and shares; `volume` is None for a mesh that is open."""
    surface = on_surface(mesh.solid, _POINTS)
    corners = _some(mesh.vertices)
    away = _outside(shapes, numpy.vstack((surface, corners)))
    beyond, points = _beyond(mesh, shapes)
    return {
        **_distances(beyond, float(away.max())),
        "uncovered": rounded(float((away[: len(surface)] > _NEAR * mesh.size).mean())),
        "volume": _volume(shapes) / abs(float(mesh.solid.volume)) if mesh.is_closed else None,
        "samples": len(surface) + len(corners) + points,
    }


def measure_surfaces(mesh: Mesh, other: Mesh) -> dict[str, Any]:
    """Return the same for a mesh that replaces another mesh: the distances of each surface from the other."""
    points = [numpy.vstack((on_surface(each.solid, _POINTS), _some(each.vertices))) for each in (other, mesh)]
    pairs = zip((mesh, other), points, strict=True)
    beyond, short = (float(TriangleSurface(each.solid.triangles).distances(some).max()) for each, some in pairs)
    closed = mesh.is_closed and other.is_closed
    return {
        **_distances(beyond, short),
        "uncovered": None,
        "samples": sum(map(len, points)),
        "volume": abs(float(other.solid.volume)) / abs(float(mesh.solid.volume)) if closed else None,
    }


def _distances(beyond: float, short: float) -> dict[str, float]:
    # A nanometre is less than the arithmetic can tell.
    beyond = round(beyond, 9)
    short = round(short, 9)
    return {"hausdorff": max(beyond, short), "beyond": beyond, "short": short}


def _some(vertices: numpy.ndarray) -> numpy.ndarray:
    """Return all vertices, or evenly spaced ones if there are very many."""
    return vertices[:: max(1, -(-len(vertices) // _VERTICES))]


def _outside(shapes: Sequence[Shape], points: numpy.ndarray) -> numpy.ndarray:
    """The distance of points from the nearest shape; zero for points in a shape."""
    found = numpy.zeros(len(points))
    rest = numpy.arange(len(points))
    for shape in shapes:
        rest = rest[~shape.contains(points[rest])]
        if not len(rest):
            return found
    # A shape is convex: the nearest point of one that a point is outside of is on its surface.
    found[rest] = numpy.min([shape.distance(points[rest]) for shape in shapes], axis=0)
    return found


def _beyond(mesh: Mesh, shapes: Sequence[Shape]) -> tuple[float, int]:
    """The distance of the outer surface of the shapes from a mesh inside them, and the number of measured points."""
    each = max(_POINTS // len(shapes), 200)
    outer = []
    for number, shape in enumerate(shapes):
        points, normals = _with_normals(shape.solid, each)
        # Pieces that were cut apart do not quite touch: a point is inside if there is another piece behind it.
        behind = points + _BEHIND * mesh.size * normals
        for other in (*shapes[:number], *shapes[number + 1 :]):
            free = ~(other.contains(behind) | other.contains(points))
            points = points[free]
            behind = behind[free]
        outer.append(points)
    points = numpy.vstack(outer)
    return _farthest_outside(mesh, numpy.unique(points, axis=0)), len(points)


def _farthest_outside(mesh: Mesh, points: numpy.ndarray) -> float:
    """Return the largest distance from the mesh of the points that are outside of it.

    The points are taken in the order of an upper bound of their distance, which is cheap, until no other point can be
    farther away.
    """
    if not len(points):
        return 0.0
    surface = TriangleSurface(mesh.solid.triangles)
    bounds = surface.upper_bounds(points)
    order = numpy.argsort(-bounds, kind="stable")
    farthest = 0.0
    for start in range(0, len(order), _AT_ONCE):
        batch = order[start : start + _AT_ONCE]
        if bounds[batch[0]] <= farthest:
            break
        distances = surface.distances(points[batch])
        for number in numpy.argsort(-distances, kind="stable"):
            if distances[number] <= farthest:
                break
            if _winding(mesh, points[batch[number]]) < 0.5:
                farthest = float(distances[number])
    return farthest


def _with_normals(solid: Any, count: int) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Points on a surface and all its corners, with the outward directions."""
    points, faces = geometry.with_faces(solid, count)
    corners = _some(solid.triangles.reshape(-1, 3))
    every = _some(numpy.repeat(numpy.arange(len(solid.faces)), 3))
    return numpy.vstack((points, corners)), solid.face_normals[numpy.concatenate((faces, every))]


def _winding(mesh: Mesh, point: numpy.ndarray) -> float:
    """The number of times that the surface surrounds a point: one inside, zero outside, and a fraction near a hole."""
    one, two, three = (mesh.solid.triangles[:, at] - point for at in range(3))
    lengths = [numpy.linalg.norm(side, axis=1) for side in (one, two, three)]
    triple = (one * numpy.cross(two, three)).sum(axis=1)
    below = lengths[0] * lengths[1] * lengths[2]
    below += (one * two).sum(axis=1) * lengths[2]
    below += (two * three).sum(axis=1) * lengths[0] + (three * one).sum(axis=1) * lengths[1]
    # A mesh may be inside out as a whole.
    return float(numpy.abs(numpy.arctan2(triple, below).sum() / (2 * numpy.pi)))


def _volume(shapes: Sequence[Shape]) -> float:
    """Return the volume of all shapes together; shared parts count once."""
    if len(shapes) == 1:
        return shapes[0].volume
    whole = 0.0
    for shape in shapes:
        points = geometry.in_solid(shape, _POINTS)
        shared = sum(other.contains(points).astype(float) for other in shapes)
        whole += shape.volume * float((1 / numpy.maximum(shared, 1)).mean()) if len(points) else shape.volume
    return whole


NEEDS = {
    **dict.fromkeys(("hull", "fit", "spheres"), ("trimesh", "scipy", "rtree")),
    "decompose": ("trimesh", "scipy", "rtree", "coacd"),
    "simplify": ("trimesh", "scipy", "rtree", "fast-simplification"),
}
"""The distributions that each method imports."""


def make(mujoco: Any, argument: dict[str, Any]) -> dict[str, Any]:
    """Return the shapes for a mesh; runs under `mjcompose.mujoco.engine.call`.

    The argument has the attributes of the `mesh`, the `method`, its settings in `wanted`, and `most_faces`. The answer
    has `missing` if a package is not installed, `unusable` if the method does not work for the mesh, and otherwise the
    entry of `mjcompose.compose.mesh_jobs`.
    """
    method = argument["method"]
    wanted = argument["wanted"]
    versions = {}
    for name in NEEDS[method]:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            return {"missing": name}
    try:
        mesh = geometry.read_mesh(mujoco, argument["mesh"], argument["most_faces"])
        if method != "simplify" and geometry.is_flat(mesh.vertices):
            raise UnusableError("it is flat")
        size = float(f"{mesh.size:.4g}")
        about = {"faces": len(mesh.faces), "closed": mesh.is_closed, "size": size, "mapped": mesh.is_mapped}
        return {**_made(mesh, method, wanted), "mesh": about, "made_with": dict(sorted(versions.items()))}
    except UnusableError as error:
        return {"unusable": str(error), "limit": error.limit}


_METHODS: Mapping[str, Callable[[Mesh, Any], Sequence[Shape]]] = {
    "hull": lambda mesh, wanted: [hull_of(mesh.vertices, wanted["vertices"])],
    "fit": lambda mesh, wanted: [fit(mesh, wanted)],
    "decompose": decompose,
    "spheres": spheres,
}


def _made(mesh: Mesh, method: str, wanted: Any) -> dict[str, Any]:
    if method == "simplify":
        smaller = simplify(mesh, wanted["faces"])
        shapes: list[Shape] = [MeshHull(smaller.vertices, smaller.faces)]
        error = measure_surfaces(mesh, smaller)
    else:
        shapes = [*_METHODS[method](mesh, wanted)]
        error = measured(mesh, shapes)
    # Four digits are the same on other machines.
    digits = {name: float(f"{value:.4g}") if isinstance(value, float) else value for name, value in error.items()}
    return {"shapes": [shape.to_data() for shape in shapes], "error": digits}
