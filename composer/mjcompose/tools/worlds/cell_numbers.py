"""The numbers of a cell in the joint model of all cells."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjcompose.mujoco.addresses import numbers_of
from mjcompose.mujoco.attributes import OF_OBJECT_TYPE
from mjcompose.mujoco.varying import arrays, flat, places_of_rows, put
from mjcompose.tools.worlds.same_tree import ADDRESSES, ASSET_REFERENCES, GEOM_REFERENCES, OF_THE_JOINT_MODEL
from mjcompose.tools.worlds.slots import GeomSlot
from mjcompose.tools.worlds.volumes import nodes_of, set_volumes

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

APART = -1e4
"""The margin of an absent geom: it never gets near anything."""
_MESH = int(mujoco.mjtGeom.mjGEOM_MESH)
_HFIELD = int(mujoco.mjtGeom.mjGEOM_HFIELD)
_WRAPPED = (int(mujoco.mjtWrap.mjWRAP_SPHERE), int(mujoco.mjtWrap.mjWRAP_CYLINDER))
_OBJECTS = {"sensor_objid": "sensor_objtype", "sensor_refid": "sensor_reftype"}
FRAMED = ("geom_pos", "geom_quat", "geom_aabb", "geom_rbound", "geom_sameframe")
"""What changes in a geom if its mesh has another frame."""


class CellNumbers:
    """Maps the arrays of a cell to a joint model.

    `geoms` are the cell's geoms by slot, -1 for absent ones, and `assets` the joint model's numbers of the cell's
    assets, by kind. `reframed` are the slots whose mesh has another frame in the joint model.
    """

    def __init__(
        self, joint: MjModel, model: MjModel, slots: Sequence[GeomSlot], cell: int, assets: Mapping[str, Sequence[int]]
    ) -> None:
        self.joint = joint
        self.model = model
        self.geoms = np.array([slot.geoms.get(cell, -1) for slot in slots], np.int64)
        self.present = np.flatnonzero(self.geoms >= 0)
        self.absent = frozenset(np.flatnonzero(self.geoms < 0).tolist())
        self.slot_of = np.full(model.ngeom + 1, -1, np.int64)
        self.slot_of[self.geoms[self.present]] = self.present
        self.assets = {kind: np.array([*numbers, -1], np.int64) for kind, numbers in assets.items()}
        self.reframed = [int(slot) for slot in self.present if self._is_reframed(int(slot))]

    def _is_reframed(self, slot: int) -> bool:
        geom = self.geoms[slot]
        mesh = int(self.model.geom_dataid[geom])
        if self.model.geom_type[geom] != _MESH or mesh < 0:
            return False
        other = self.assets["mesh"][mesh]
        same = [(getattr(self.joint, name)[other] == getattr(self.model, name)[mesh]).all() for name in _MESH_FRAME]
        return not all(same)

    def whole(self) -> MjModel:
        """Return the joint model with the numbers of the cell."""
        made = copy.copy(self.joint)
        for name in arrays(self.joint):
            if not is_once(name) and not name.startswith("mat_"):
                to = self.places(name)
                flat_of = flat(made, name)
                flat_of[to.joint] = self.values(name, flat(self.model, name))[to.cell]
                put(made, name, flat_of)
        for slot in self.reframed:
            self._into_frame(made, slot)
        for slot in self.absent:
            made.geom_margin[slot] = APART
            made.geom_gap[slot] = 0
            made.geom_fluid[slot] = 0
            made.geom_rgba[slot] = 0
            made.geom_matid[slot] = -1
        self._set_volumes(made)
        return made

    def of(self, model: MjModel) -> CellNumbers:
        """Return the same places for another world of the cell."""
        other = copy.copy(self)
        other.model = model
        return other

    def places(self, name: str) -> Places:
        """Return the flat indices of an array's numbers, in the joint model and in the cell."""
        if name.startswith("geom_"):
            return _of_rows(getattr(self.model, name), self.present, self.geoms[self.present])
        if name.startswith("mat_"):
            return _of_rows(getattr(self.model, name), self.assets["material"][:-1], np.arange(self.model.nmat))
        every = np.arange(flat(self.model, name).size)
        return Places(every, every)

    def values(self, name: str, own: NDArray[Any]) -> NDArray[Any]:
        """Return numbers of an array for the joint model, which has other ids of geoms and assets.

        `own` is the whole array, or for several worlds one whole array for each.
        """
        kind = "material" if name == "geom_matid" else ASSET_REFERENCES.get(name)
        if kind is not None:
            own = self.assets[kind][own]
        elif name == "geom_dataid":
            own = self._data(own)
        elif name in GEOM_REFERENCES:
            is_geom = self._names_geoms(name)
            own = np.where(is_geom, self.slot_of[np.where(is_geom, own, -1)], own)
        return own

    def _data(self, own: NDArray[Any]) -> NDArray[Any]:
        shape = self.model.geom_type
        is_mesh = (shape == _MESH) & (own >= 0)
        is_hfield = (shape == _HFIELD) & (own >= 0)
        # MuJoCo leaves the id of a mesh in a primitive that was fitted to it, and reads it nowhere.
        meshes = self.assets["mesh"][np.where(is_mesh, own, -1)]
        return np.where(is_hfield, self.assets["hfield"][np.where(is_hfield, own, -1)], meshes)

    def _names_geoms(self, name: str) -> NDArray[np.bool_]:
        if name == "wrap_objid":
            return np.isin(self.model.wrap_type, _WRAPPED)
        if name in _OBJECTS:
            return np.array(
                [OF_OBJECT_TYPE.get(kind) == "geom" for kind in getattr(self.model, _OBJECTS[name]).tolist()], bool
            )
        return np.ones(self.model.npair, bool)

    def _into_frame(self, made: MjModel, slot: int) -> None:
        """Move a geom into the frame of its mesh in the joint model; the mesh stays where it is."""
        mesh = int(self.model.geom_dataid[self.geoms[slot]])
        other = int(made.geom_dataid[slot])
        pos = np.zeros(3)
        quat = np.zeros(4)
        in_body = np.zeros(3)
        turn = np.zeros(4)
        mujoco.mju_negPose(pos, quat, self.model.mesh_pos[mesh], self.model.mesh_quat[mesh])
        mujoco.mju_mulPose(in_body, turn, made.geom_pos[slot].copy(), made.geom_quat[slot].copy(), pos, quat)
        mujoco.mju_mulPose(pos, quat, in_body, turn, made.mesh_pos[other].copy(), made.mesh_quat[other].copy())
        made.geom_pos[slot] = pos
        made.geom_quat[slot] = quat
        vertices = numbers_of(made, "mesh", "mesh_vert", other).astype(float)
        low = vertices.min(axis=0)
        high = vertices.max(axis=0)
        made.geom_aabb[slot] = np.concatenate(((low + high) / 2, (high - low) / 2)).reshape(made.geom_aabb[slot].shape)
        made.geom_rbound[slot] = np.linalg.norm(np.maximum(np.abs(low), np.abs(high)))
        made.geom_sameframe[slot] = 0

    def _set_volumes(self, made: MjModel) -> None:
        computed = []
        for body in range(made.nbody):
            ours = nodes_of(made, body)
            theirs = nodes_of(self.model, body)
            if self._has_same_volumes(body, ours, theirs):
                made.bvh_aabb[ours.start : ours.stop] = self.model.bvh_aabb[theirs.start : theirs.stop]
            else:
                computed.append(body)
        set_volumes(made, computed, self.absent)

    def _has_same_volumes(self, body: int, ours: range, theirs: range) -> bool:
        joint = self.joint
        if len(ours) != len(theirs) or any(joint.geom_bodyid[slot] == body for slot in self.reframed):
            return False
        geoms = joint.bvh_nodeid[ours.start : ours.stop]
        others = self.model.bvh_nodeid[theirs.start : theirs.stop]
        children = joint.bvh_child[ours.start : ours.stop] == self.model.bvh_child[theirs.start : theirs.stop]
        return bool((geoms == self.slot_of[others]).all() and children.all())


_MESH_FRAME = ("mesh_pos", "mesh_quat")


class Places:
    """The flat indices of numbers in an array of the joint model, and of the same numbers in the cell."""

    def __init__(self, joint: NDArray[np.int64], cell: NDArray[np.int64]) -> None:
        self.joint = joint
        self.cell = cell


def _of_rows(array: NDArray[Any], joint: NDArray[np.int64], cell: NDArray[np.int64]) -> Places:
    return Places(places_of_rows(array, joint), places_of_rows(array, cell))


def is_once(name: str) -> bool:
    """Return whether an array is the joint model's own, and no cell has other numbers in it.

    Colors of materials are not among them: worlds may draw these.
    """
    word = name.partition("_")[0]
    return (word in OF_THE_JOINT_MODEL and word != "mat") or name in ADDRESSES or name == "geom_bodyid"
