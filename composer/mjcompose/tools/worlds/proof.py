"""Compare a world of a joint model with the model of its cell."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from mjcompose.mujoco.addresses import numbers_of
from mjcompose.mujoco.varying import arrays, flat
from mjcompose.tools.worlds.cell_numbers import APART, FRAMED, CellNumbers, is_once
from mjcompose.tools.worlds.names import failure
from mjcompose.tools.worlds.same_tree import CODE
from mjcompose.tools.worlds.volumes import nodes_of

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_STEPS = 10
_NEAR = 1e-9
"""A mesh in another frame has other last bits."""
_NEAR_FLOAT = 1e-6
"""Vertices are in single precision."""


def check_cell(cell: CellNumbers, made: MjModel, alone: MjModel, name: str) -> None:
    """Raise LoadError unless a world of the joint model is the model that was built alone, and steps like it."""
    different = [*_different_arrays(cell, made, alone), *_different_geoms(cell, made, alone)]
    if not different:
        different = [*_different_steps(made, alone)]
    if different:
        listed = ", ".join(f"`{each}`" for each in dict.fromkeys(different))
        help = "build this cell by itself with `--pick`"
        raise failure(CODE, f"`{name}` differs from its world in the joint model: {listed}", help)


def _different_arrays(cell: CellNumbers, made: MjModel, alone: MjModel) -> Iterator[str]:
    for array in arrays(alone):
        if is_once(array):
            continue
        places = cell.places(array)
        wanted = cell.values(array, flat(alone, array))[places.cell]
        equal = flat(made, array)[places.joint] == wanted
        if array in FRAMED and cell.reframed:
            width = flat(alone, array).size // alone.ngeom
            equal |= np.isin(places.joint // width, cell.reframed)
        is_number = wanted == wanted if wanted.dtype.kind == "f" else np.ones(wanted.shape, bool)
        if not equal[is_number].all():
            yield array


def _different_geoms(cell: CellNumbers, made: MjModel, alone: MjModel) -> Iterator[str]:
    """Yield the arrays in which meshes, height fields, absent geoms or bounding volumes differ from the cell."""
    for slot in cell.present.tolist():
        geom = int(cell.geoms[slot])
        kind = _KINDS_WITH_DATA.get(int(alone.geom_type[geom]))
        if kind is not None:
            yield from _different_data(kind, (made, slot), (alone, geom))
    if any(made.geom_margin[slot] != APART for slot in cell.absent):
        yield "geom_margin"
    framed = {int(made.geom_bodyid[slot]) for slot in cell.reframed}
    for body in range(alone.nbody):
        ours = nodes_of(made, body)
        theirs = nodes_of(alone, body)
        if ours and theirs and body not in framed:
            boxes = made.bvh_aabb[ours.start], alone.bvh_aabb[theirs.start]
            if not np.allclose(*boxes, rtol=_NEAR, atol=_NEAR):
                yield "bvh_aabb"


_KINDS_WITH_DATA = {int(mujoco.mjtGeom.mjGEOM_MESH): "mesh", int(mujoco.mjtGeom.mjGEOM_HFIELD): "hfield"}


def _different_data(kind: str, made: tuple[MjModel, int], alone: tuple[MjModel, int]) -> Iterator[str]:
    if kind == "hfield":
        if not np.array_equal(_heights(*made), _heights(*alone)):
            yield "hfield_data"
        return
    ours = _vertices(*made)
    theirs = _vertices(*alone)
    if ours.shape != theirs.shape or not np.allclose(
        ours, theirs, rtol=0, atol=_NEAR_FLOAT * max(1, abs(theirs).max())
    ):
        yield "mesh_vert"
    has_hull = [int(model.mesh_graphadr[model.geom_dataid[geom]]) >= 0 for model, geom in (made, alone)]
    if has_hull[1] and not has_hull[0]:
        yield "mesh_graph"


def _heights(model: MjModel, geom: int) -> np.ndarray:
    field = int(model.geom_dataid[geom])
    heights = numbers_of(model, "hfield", "hfield_data", field)
    grid = (model.hfield_nrow[field], model.hfield_ncol[field])
    return np.concatenate((grid, model.hfield_size[field], heights))


def _vertices(model: MjModel, geom: int) -> np.ndarray:
    """Return the vertices of a geom's mesh, in the frame of its body."""
    mesh = int(model.geom_dataid[geom])
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
    vertices = numbers_of(model, "mesh", "mesh_vert", mesh).astype(float)
    return np.asarray(vertices @ turn.reshape(3, 3).T + model.geom_pos[geom])


def _different_steps(made: MjModel, alone: MjModel) -> Iterator[str]:
    states = []
    for model in (made, alone):
        data = mujoco.MjData(model)
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_step(model, data, _STEPS)
        states.append(data.qpos.copy())
    if not np.allclose(states[0], states[1], rtol=_NEAR, atol=_NEAR, equal_nan=True):
        yield "qpos"
