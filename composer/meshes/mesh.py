"""A mesh as MuJoCo reads it: scaled and placed, before MuJoCo moves it to its centre of mass."""

from __future__ import annotations

from typing import Any
from xml.sax.saxutils import quoteattr

import numpy

from composer.dataclass import dataclass
from composer.meshes.plausible import is_flat


class UnusableError(Exception):
    """Why nothing can be made of a mesh, as the end of a sentence, and the `limit` that it goes beyond, if so."""

    def __init__(self, why: str, limit: str | None = None) -> None:
        super().__init__(why)
        self.limit = limit


@dataclass(frozen=True)
class Mesh:
    """Vertices in metres and triangles by their numbers. `solid` is the same as trimesh has it.

    `is_mapped` says whether it says where a texture goes.
    """

    vertices: numpy.ndarray
    faces: numpy.ndarray
    solid: Any
    is_mapped: bool = False

    @property
    def is_closed(self) -> bool:
        """Whether it has an inside: every edge has two triangles, which turn the same way."""
        return bool(self.solid.is_watertight and self.solid.is_winding_consistent)

    @property
    def size(self) -> float:
        """The diagonal of the box around it."""
        return float(numpy.linalg.norm(numpy.ptp(self.vertices, axis=0)))


def read_mesh(mujoco: Any, attributes: dict[str, str], most_faces: int) -> Mesh:
    """The mesh that an element `<mesh>` with these attributes is. Raises UnusableError."""
    import trimesh

    # As a shell it may be open or flat. A geom that touches nothing needs no hull, which a flat mesh does not have.
    given = {**attributes, "name": "mesh", "inertia": "shell"}
    text = " ".join(f"{name}={quoteattr(value)}" for name, value in given.items())
    model_text = (
        f'<mujoco><asset><mesh {text}/></asset><worldbody><geom type="mesh" mesh="mesh" contype="0"'
        ' conaffinity="0"/></worldbody></mujoco>'
    )
    try:
        model = mujoco.MjModel.from_xml_string(model_text)
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


def check_thick(mesh: Mesh) -> None:
    """Raises UnusableError for a mesh that is a point, a line or flat."""
    if is_flat(mesh.vertices):
        raise UnusableError("it is flat")
