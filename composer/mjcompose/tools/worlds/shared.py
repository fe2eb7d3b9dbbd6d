"""The error about a number that a simulator has once for all worlds: which cells differ in it, and where."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco as mujoco_module
import numpy as np

from mjcompose.mujoco.attributes import NameTable
from mjcompose.mujoco.varying import whose
from mjcompose.tools.worlds.names import LoadError, failure

if TYPE_CHECKING:
    from mjcompose.tools.worlds.worlds import Worlds

CODE = "not-per-world"
INSTEAD = "remove its changes from the recipe, or use `worlds.mujoco`"
_HELPS = {"jnt_limited": "give the joint a wide `range` instead of no limit"}
_HFIELD = int(mujoco_module.mjtGeom.mjGEOM_HFIELD)
_WITH_DATA = (_HFIELD, int(mujoco_module.mjtGeom.mjGEOM_MESH))


def shared_error(simulator: str, worlds: Worlds, array: str) -> LoadError:
    """Return the error about an array that a simulator shares among all worlds."""
    message = f"{simulator} shares `{array}` among all worlds"
    note = difference(worlds, array)
    return failure(CODE, message, _HELPS.get(array, INSTEAD), notes=[] if note is None else [note])


def check_shapes(worlds: Worlds) -> None:
    """Raise LoadError if MJX cannot have the meshes and height fields of all worlds.

    It has one for each geom, and no margin for their contacts, which absent geoms need.
    """
    model = worlds.nominal
    help = "use `worlds.warp`, or shapes of one type in all cells"
    if "geom_dataid" in worlds.arrays:
        element, _, cells = _first_difference(worlds, "geom_dataid")
        kind = _kind_of_data(worlds, int(worlds.arrays["geom_dataid"].index[0]))
        message = f"MJX has one {kind} for each geom, and these cells differ in the {kind} of {_quoted(element)}"
        raise failure(CODE, message, help, notes=[cells] if cells else [])
    is_shape = np.isin(model.geom_type, _WITH_DATA)
    present = worlds.table.present
    missing = np.flatnonzero(is_shape & ~present.all(axis=0)).tolist() if present.size else []
    for geom in missing[:1]:
        kind = _kind_of_data(worlds, geom)
        without = worlds.table.cells[int(np.argmin(present[:, geom]))]["name"]
        element = _quoted(NameTable(model).describe("geom", geom))
        message = f"MJX has each {kind} in all worlds, and the cell `{without}` lacks that of {element}"
        raise failure(CODE, message, help)


def _kind_of_data(worlds: Worlds, geom: int) -> str:
    return "height field" if worlds.nominal.geom_type[geom] == _HFIELD else "mesh"


def difference(worlds: Worlds, array: str) -> str | None:
    """Return two cells that differ in an array, and the element: `these cells differ in it: …`; None without cells."""
    element, kind, cells = _first_difference(worlds, array)
    owner = f", of the {kind} {_quoted(element)}" if element else ""
    return f"these cells differ in it: {cells}{owner}" if cells else None


def _quoted(element: str) -> str:
    return element if element.startswith("#") else f"`{element}`"


def _first_difference(worlds: Worlds, array: str) -> tuple[str, str, str]:
    varying = worlds.arrays[array]
    differs = (varying.values != varying.values[:1]).any(axis=0)
    column = int(np.argmax(differs))
    (owner,) = whose(worlds.nominal, array, varying.index[column : column + 1])
    other = int(np.argmax(varying.values[:, column] != varying.values[0, column]))
    names = dict.fromkeys(
        str(worlds.table.cells[worlds.table.cell[each]]["name"]) for each in (0, other) if worlds.table.cells
    )
    return owner.element, owner.kind, ", ".join(f"`{name}`" for name in names) if len(names) > 1 else ""
