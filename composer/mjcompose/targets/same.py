"""Compare a model with the model that MuJoCo reads back. Runs in MuJoCo's child process.

Every array of `mjModel` is compared. MuJoCo computes the frame of a mesh from the vertices that it reads, so the frame
may differ; an element with a mesh is therefore compared by the place of its surface.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.arrays import REWRITTEN, with_trait
from mjcompose.mujoco.attributes import NameTable
from mjcompose.mujoco.compare import unequal_attributes
from mjcompose.mujoco.unequal import Bound, differing_rows, unequal
from mjcompose.targets.readers.shared.facts import rotation

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Pose = tuple[Any, Any]
"""Position, shape (3,), and rotation matrix, shape (3, 3)."""


def pose(pos: Any, quat: Any = (1.0, 0.0, 0.0, 0.0)) -> Pose:
    """Return the pose with a position (m) and a quaternion (w, x, y, z), which is normalized."""
    return np.asarray(pos, dtype=float), rotation(np.asarray(quat) / np.linalg.norm(quat))


def about(axis: Any, angle: float) -> Pose:
    """Return the rotation by an angle (rad) about an axis through the origin."""
    half = angle / 2
    return pose((0, 0, 0), (math.cos(half), *(math.sin(half) * np.asarray(axis))))


def shifted(by: Any) -> Pose:
    return np.asarray(by, dtype=float), np.eye(3)


def joined(*poses: Pose) -> Pose:
    """Return the product of poses: each pose is in the frame of the previous pose."""
    at, turned = shifted((0, 0, 0))
    for pos, by in poses:
        at = at + turned @ pos
        turned = turned @ by
    return at, turned


def back(of: Pose) -> Pose:
    """Return the inverse of a pose."""
    return -(of[1].T @ of[0]), of[1].T


def quat(turned: Any) -> Any:
    """Return the quaternion (w, x, y, z) of a rotation matrix, shape (4,).

    >>> [round(float(each), 6) for each in quat(about((0, 0, 1), 1.0)[1])]
    [0.877583, 0.0, 0.0, 0.479426]
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = turned
    squares = np.array([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz])
    mixed = [
        [squares[0], zy - yz, xz - zx, yx - xy],
        [zy - yz, squares[1], yx + xy, xz + zx],
        [xz - zx, yx + xy, squares[2], zy + yz],
        [yx - xy, xz + zx, zy + yz, squares[3]],
    ]
    row = np.array(mixed[int(squares.argmax())])
    return row / np.linalg.norm(row)


TOLERANCE = 1e-6
"""Relative to 1 or the largest value of an array, and to the size of a surface."""

_OF_MESH_FRAMES = ("mesh_", "oct_", "nmesh", "npolygonmax", "nbvh", "noct")
_REWRITTEN = {*with_trait(REWRITTEN), "signature"}
_POSES = ("geom_pos", "geom_quat", "geom_sameframe", "geom_size", "site_pos", "site_quat", "site_sameframe")
_MESHES = (7, 8)  # mjGEOM_MESH, mjGEOM_SDF
_SURFACE = "surface"
_LOOKS = ("tendon_rgba", "tendon_width")  # a fixed tendon has no attributes for them, only its class
_FIXED = 0  # mjTENDON_FIXED
_NO_BIAS = 0  # mjBIAS_NONE; with it, a motor of MuJoCo 3.12 keeps the bias that its class gives to positions


def differences(model: MjModel, again: Any) -> Iterator[str]:
    """Yield the differences of the model that was read back, in words with the names of the arrays."""
    for name, before, after in unequal_attributes(model, again):
        if name.startswith(_OF_MESH_FRAMES) or name in _REWRITTEN:
            continue
        difference = _difference(model, name, before, after)
        if difference is not None:
            yield f"`{name}`{difference}"
    if model.ngeom == again.ngeom and model.nmesh == again.nmesh:
        for kind in ("geom", "site"):
            yield from _surfaces(kind, model, again)


def _difference(model: MjModel, name: str, before: Any, after: Any) -> str | None:
    """Return how two values differ, in words; None if they count as equal."""
    if not isinstance(before, np.ndarray) or not isinstance(after, np.ndarray):
        are_floats = isinstance(before, float) and isinstance(after, float)
        is_near = are_floats and Bound(TOLERANCE, floor=0.0).allows(before, after)
        return None if is_near else f": {after}, not {before}"
    if before.shape != after.shape:
        return f" has another length: {before.size}, not {after.size}"
    rows = _rows(model, name)
    different = np.zeros(before.shape, dtype=np.bool_)
    different[rows] = unequal(before[rows], after[rows], Bound(TOLERANCE, of="array"))
    if not different.any():
        return None
    row = differing_rows(different)[0]
    return f", row {row}: {after[row]}, not {before[row]}"


def _rows(model: MjModel, name: str) -> Any:
    """Return the rows of an array that have a meaning: for example, fixed tendons have no looks."""
    kind = name.partition("_")[0]
    if name in _POSES:
        return ~np.isin(getattr(model, f"{kind}_type"), _MESHES)
    if name == "actuator_biasprm":
        return model.actuator_biastype != _NO_BIAS
    return model.tendon_type != _FIXED if name in _LOOKS else slice(None)


def _surfaces(kind: str, model: MjModel, again: Any) -> Iterator[str]:
    table = NameTable(model)
    for number in np.flatnonzero(np.isin(getattr(model, f"{kind}_type"), _MESHES)).tolist():
        if getattr(model, f"{kind}_dataid")[number] < 0:
            continue
        read = _surface(kind, again, number)
        for (what, tolerance), before in _surface(kind, model, number).items():
            after = read.get((what, tolerance))
            called = f"the {what} of {kind} {table.describe(kind, number)}"
            if after is None or before.shape != after.shape:
                yield f"{called} has another number of faces"
                continue
            size = max(float(np.ptp(before, axis=0).max(initial=0.0)), 1e-9) if what == _SURFACE else 1.0
            if not np.isclose(before, after, rtol=0, atol=tolerance * size).all():
                yield f"{called} is up to {float(np.abs(before - after).max()):g} off"


def _surface(kind: str, model: MjModel, number: int) -> dict[tuple[str, float], Any]:
    """Return data at the corners of a mesh's faces in the frame of its body, by name and tolerance.

    Each array has the shape (n, 3), or (n, 2) for texture coordinates.
    """
    mesh = int(getattr(model, f"{kind}_dataid")[number])
    quat, pos = (getattr(model, f"{kind}_{name}")[number] for name in ("quat", "pos"))
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])

    def corners(name: str, of_faces: Any) -> Any:
        start = int(getattr(model, f"mesh_{name}adr")[mesh])
        return getattr(model, f"mesh_{name}")[start + of_faces[faces].ravel()]

    found = {
        (_SURFACE, 10 * TOLERANCE): rotated(quat, corners("vert", model.mesh_face)) + pos,
        ("normals", 1000 * TOLERANCE): rotated(quat, corners("normal", model.mesh_facenormal)),
    }
    if model.mesh_texcoordadr[mesh] >= 0:
        found["texture coordinates", 10 * TOLERANCE] = corners("texcoord", model.mesh_facetexcoord)
    return found


def rotated(quat: Any, points: Any) -> Any:
    """Return points, shape (n, 3), rotated by a quaternion (w, x, y, z)."""
    w = quat[0]
    axis = np.asarray(quat[1:])
    turned = 2 * np.cross(axis, points)
    return points + w * turned + np.cross(axis, turned)
