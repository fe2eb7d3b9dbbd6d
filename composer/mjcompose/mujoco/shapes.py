"""Meshes and convex shapes, points on them, and whether a mesh is plausible: enormous, in millimeters, flat or open.

`measures` and `is_flat` run in the child process, where the vertices are. `doubts` evaluates their answer here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.mujoco.surface import TriangleSurface


class UnusableError(Exception):
    """The reason that a mesh cannot be used, as the end of a sentence, and the `limit` that it exceeds, if any."""

    def __init__(self, why: str, limit: str | None = None) -> None:
        super().__init__(why)
        self.limit = limit


@dataclass(frozen=True)
class Mesh:
    """Vertices in meters and triangles by their numbers. `solid` is the same mesh for trimesh.

    `is_mapped` says whether the mesh has texture coordinates.
    """

    vertices: numpy.ndarray
    faces: numpy.ndarray
    solid: Any
    is_mapped: bool = False

    @property
    def is_closed(self) -> bool:
        """Whether it encloses a volume: every edge has two triangles of the same orientation."""
        return bool(self.solid.is_watertight and self.solid.is_winding_consistent)

    @property
    def size(self) -> float:
        """The diagonal of the box around it."""
        return float(numpy.linalg.norm(numpy.ptp(self.vertices, axis=0)))


def read_mesh(mujoco: Any, attributes: dict[str, str], most_faces: int) -> Mesh:
    """The mesh of a `<mesh>` element with these attributes. Raises UnusableError."""
    import trimesh

    # As a shell it may be open or flat. A geom that touches nothing needs no hull, which a flat mesh does not have.
    given = {**attributes, "name": "mesh", "inertia": "shell"}
    text = " ".join(f"{name}={quoteattr(value)}" for name, value in given.items())
    world = '<worldbody><geom type="mesh" mesh="mesh" contype="0" conaffinity="0"/></worldbody>'
    try:
        model = mujoco.MjModel.from_xml_string(f"<mujoco><asset><mesh {text}/></asset>{world}</mujoco>")
    except ValueError as error:
        raise UnusableError(f"MuJoCo cannot read it: {' '.join(str(error).split())}") from error
    faces = numpy.array(model.mesh_face, dtype=numpy.int64)
    if len(faces) > most_faces:
        raise UnusableError(f"it has {len(faces)} faces, and {most_faces} are allowed", "mesh-faces")
    turn = numpy.zeros(9)
    mujoco.mju_quat2Mat(turn, model.mesh_quat[0])
    vertices = numpy.array(model.mesh_vert, dtype=float) @ turn.reshape(3, 3).T + model.mesh_pos[0]
    solid = trimesh.Trimesh(vertices, faces, process=True)
    mapped = bool(model.mesh_texcoordnum[0] > 0)
    return Mesh(numpy.asarray(solid.vertices), numpy.asarray(solid.faces), solid, is_mapped=mapped)


def on_surface(solid: Any, count: int, seed: int = 0) -> numpy.ndarray:
    """Return `count` points, evenly spread over the surface."""
    return with_faces(solid, count, seed)[0]


def with_faces(solid: Any, count: int, seed: int = 0) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Return the same points, and the face of each."""
    random = numpy.random.Generator(numpy.random.PCG64(seed))
    ends = numpy.cumsum(solid.area_faces)
    faces = numpy.minimum(numpy.searchsorted(ends, random.random(count) * ends[-1]), len(ends) - 1)
    one, other = random.random((2, count, 1))
    over = one + other > 1
    one = numpy.where(over, 1 - one, one)
    other = numpy.where(over, 1 - other, other)
    first, second, third = numpy.moveaxis(solid.triangles[faces], 1, 0)
    return numpy.asarray(first + one * (second - first) + other * (third - first)), faces


def in_solid(shape: Any, count: int) -> numpy.ndarray:
    """Return about `count` points inside a shape, drawn from the box around it."""
    random = numpy.random.Generator(numpy.random.PCG64(0))
    low, high = shape.solid.bounds
    share = max(shape.volume / float(numpy.prod(high - low)), 0.05)
    points = low + random.random((int(count / share), 3)) * (high - low)
    return numpy.asarray(points[shape.contains(points)])


_ON = 1e-9
_FINE = 4
"""The number of times that the triangles of a ball are divided; its surface is then off by 0.2 % of the radius."""


def rounded(number: float) -> float:
    """Return a number with seven digits, as MuJoCo keeps it in a mesh: the same on every machine."""
    return float(f"{number:.7g}") + 0.0


@dataclass(frozen=True)
class MeshHull:
    """The convex hull of its vertices."""

    vertices: numpy.ndarray
    faces: numpy.ndarray

    def to_data(self) -> dict[str, Any]:
        vertices = [[rounded(each) for each in vertex] for vertex in self.vertices]
        return {"type": "mesh", "vertices": vertices, "faces": self.faces.tolist()}

    @cached_property
    def solid(self) -> Any:
        import trimesh

        return trimesh.Trimesh(self.vertices, self.faces, process=False)

    @cached_property
    def _planes(self) -> numpy.ndarray:
        normals = self.solid.face_normals
        return numpy.column_stack((normals, -(normals * self.solid.triangles[:, 0]).sum(axis=1)))

    @property
    def volume(self) -> float:
        return abs(float(self.solid.volume))

    def contains(self, points: numpy.ndarray) -> numpy.ndarray:
        above = points @ self._planes[:, :3].T + self._planes[:, 3]
        return numpy.asarray(above.max(axis=1, initial=-numpy.inf) <= _ON)

    def distance(self, points: numpy.ndarray) -> numpy.ndarray:
        """The distance of points that are outside."""
        return TriangleSurface(self.solid.triangles).distances(points)


@dataclass(frozen=True)
class Primitive:
    """A box, sphere, capsule or cylinder; `size` is the size of MuJoCo's geom, and `turn` is a matrix."""

    type: str
    size: tuple[float, ...]
    pos: numpy.ndarray
    turn: numpy.ndarray

    def to_data(self) -> dict[str, Any]:
        from trimesh.transformations import quaternion_from_matrix

        whole = numpy.eye(4)
        whole[:3, :3] = self.turn
        quat = quaternion_from_matrix(whole)
        numbers = {"size": self.size, "pos": self.pos, "quat": -quat if quat[0] < 0 else quat}
        return {"type": self.type, **{name: [*map(rounded, each)] for name, each in numbers.items()}}

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
        whole[:3, :3] = self.turn
        whole[:3, 3] = self.pos
        made.apply_transform(whole)
        return made

    @property
    def volume(self) -> float:
        if self.type == "box":
            return float(8 * numpy.prod(self.size))
        ball = 4 / 3 * numpy.pi * self.size[0] ** 3 if self.type != "cylinder" else 0.0
        return float((2 * numpy.pi * self.size[0] ** 2 * self.size[1] if self.type != "sphere" else 0.0) + ball)

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


Shape = MeshHull | Primitive


def hull_of(vertices: numpy.ndarray, most: int | None = None) -> MeshHull:
    """Return the convex hull of points, with at most `most` vertices."""
    from scipy.spatial import ConvexHull

    # Qhull starts with a tetrahedron and stops after `TA` more vertices, as MuJoCo lets it for `maxhullvert`.
    found = ConvexHull(vertices, qhull_options="Qt" if most is None else f"Qt TA{most - 4}")
    kept = numpy.unique(found.simplices)
    faces = numpy.searchsorted(kept, found.simplices)
    corners = vertices[kept]
    # Qhull turns its triangles either way.
    normals = numpy.cross(corners[faces[:, 1]] - corners[faces[:, 0]], corners[faces[:, 2]] - corners[faces[:, 0]])
    wrong = (normals * found.equations[:, :3]).sum(axis=1) < 0
    faces[wrong] = faces[wrong][:, ::-1]
    return MeshHull(corners, faces)


# The codes of the warnings.
SIZE = "mesh-size"
SHAPE = "mesh-shape"

# In meters, a hall and a screw. Beyond these a mesh is doubtful, but not in a model that is as large itself.
_LARGE = 20.0
_SMALL = 1e-3
_TIMES = 50.0
"""By the distance of neighboring bodies."""
_LEAST_REACH = 0.1
_THIN = 1e-6
"""Relative: MuJoCo keeps coordinates with seven digits, so anything thinner than this is flat."""
_MOST = 1e9
_FACTORS = {"large": (0.001, "its file is in millimeters"), "small": (1000, "it is scaled twice")}
"""The factor for the scale of a mesh, and the reason."""


class MeshMeasurements(Struct):
    """The measurements of a mesh: `size` is the diagonal of the box around it, in meters, in the model.

    It is closed if every edge has two faces. `open_edges` of the `edges` do not; None if they are not known.
    """

    size: float
    is_flat: bool = False
    is_closed: bool = True
    open_edges: int | None = None
    edges: int | None = None


class Doubt(Struct):
    """The reason that a mesh may be a mistake: `large`, `small`, `flat` or `open`; `what` is the end of a sentence."""

    kind: str
    what: str

    @property
    def code(self) -> str:
        return SIZE if self.kind in _FACTORS else SHAPE

    def advice(self, scale: Sequence[float], write: str, between: str = " ") -> str:
        """Return the help for a wrong size; `write` sets the scale of the mesh, with `{}` for the numbers.

        >>> Doubt("large", "").advice((1, 1, 2), 'scale="{}"')
        'if its file is in millimeters, write `scale="0.001 0.001 0.002"`'
        """
        factor, why = _FACTORS[self.kind]
        return f"if {why}, write `{write.format(between.join(f'{each * factor:g}' for each in scale))}`"


def doubts(mesh: MeshMeasurements, reach: float, *, touches: bool = True, inside: str | None = None) -> Iterator[Doubt]:
    """Yield the doubts about a mesh. `reach` is the largest distance between neighboring bodies, in meters.

    A mesh that nothing touches (`touches` is false) may be flat. `inside` is a clause about a use that needs a volume;
    without it, a mesh may be open, because MuJoCo lets its convex hull collide.

    >>> [each.what for each in doubts(MeshMeasurements(300.0), 0.4)]
    ['is 300 m from corner to corner, and neighboring bodies are at most 0.4 m apart']
    >>> [each.code for each in doubts(MeshMeasurements(0.2, is_closed=False), 0.4, inside="it has a mass")]
    ['mesh-shape']
    """
    reach = max(reach, _LEAST_REACH)
    is_large = mesh.size > _LARGE and mesh.size > _TIMES * reach
    if is_large or (0 < mesh.size < _SMALL and reach > _TIMES * mesh.size):
        size = f"{mesh.size:.3g} m" if mesh.size >= 1 else f"{1000 * mesh.size:.3g} mm"
        far = f"is {size} from corner to corner, and neighboring bodies are at most {reach:.2g} m apart"
        yield Doubt("large" if is_large else "small", far)
    if touches and mesh.is_flat:
        yield Doubt("flat", "is flat: it has no volume and nothing is inside it")
    elif inside is not None and not mesh.is_closed:
        counted = f" ({mesh.open_edges} of {mesh.edges} edges have no second face)" if mesh.open_edges else ""
        yield Doubt("open", f"is open{counted}, and {inside}")


def measures(vertices: Any, faces: Any) -> dict[str, Any]:
    """Return the extents in meters, the volume, whether it is flat, and the number of edges without two faces."""
    extents = vertices.max(axis=0) - vertices.min(axis=0)
    _, same = numpy.unique(vertices, axis=0, return_inverse=True)
    corners = same.ravel()[faces]
    corners = corners[(corners != numpy.roll(corners, 1, axis=1)).all(axis=1)]
    edges = numpy.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, counts = numpy.unique(edges, axis=0, return_counts=True)
    a, b, c = (vertices[faces[:, corner]] - vertices.mean(axis=0) for corner in range(3))
    volume = float(abs((a * numpy.cross(b, c)).sum()) / 6)
    return {
        "extents": [min(float(each), _MOST) for each in extents],
        "volume": min(volume, _MOST),
        "flat": is_flat(vertices),
        "open": int((counts % 2).sum()),
        "edges": len(counts),
    }


def measured(facts: dict[str, Any], scale: Sequence[float]) -> MeshMeasurements:
    """Return the result of `measures` for a mesh with this scale."""
    size = math.dist((0, 0, 0), [factor * each for factor, each in zip(scale, facts["extents"], strict=True)])
    return MeshMeasurements(size, facts["flat"], not facts["open"], open_edges=facts["open"], edges=facts["edges"])


def is_flat(vertices: Any) -> bool:
    """Whether vertices, shape (n, 3), form a point or a line, or are in a plane, in any orientation."""
    centered = vertices - vertices.mean(axis=0)
    _, lengths, axes = numpy.linalg.svd(centered, full_matrices=False)
    thick = numpy.ptp(centered @ axes.T, axis=0)
    return len(lengths) < 3 or bool(thick.min() <= _THIN * thick.max())
