"""The start of each world: numbers that MuJoCo Warp computes from a model when it makes its data."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import mujoco as mujoco_module
import numpy as np
from numpy.typing import NDArray

from mjcompose.mujoco.varying import flat

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel
    from mjcompose.tools.worlds.worlds import Varying

_STATE = ("qpos", "mocap_pos", "mocap_quat", "eq_active", "history", "plastic")
"""Arrays that `mujoco_warp.make_data` copies from the host's data after a reset."""
_POSES = ("geom_xpos", "geom_xmat")


def fixed_geoms(model: MjModel) -> NDArray[np.int64]:
    """Return the geoms whose poses no step of MuJoCo Warp computes.

    MuJoCo Warp 4.0 computes them when it makes its data, from the host's model (`_geom_local_to_global` in
    `smooth.py`).
    """
    body = model.geom_bodyid
    return np.flatnonzero((model.body_weldid[body] == 0) & (model.body_mocapid[model.body_rootid[body]] < 0))


def of_arrays(arrays: Mapping[str, Varying]) -> dict[str, Varying]:
    """Return the arrays of a table, without options and means, which play no part in the start."""
    return {name: own for name, own in arrays.items() if "." not in name}


def starts(model: MjModel, arrays: Mapping[str, Varying], count: int) -> Iterator[MjData]:
    """Yield MuJoCo's data at the start of each world, always in the same memory."""
    model = copy.copy(model)
    # With these flags, MuJoCo uses the pose of the body for its geom, and worlds may move the geom alone.
    model.geom_sameframe[:] = 0
    model.body_sameframe[:] = 0
    data = mujoco_module.MjData(model)
    memory = [(flat(model, name), own) for name, own in arrays.items() if not name.endswith("_sameframe")]
    for world in range(count):
        for array, own in memory:
            array[own.index] = own.values[world]
        mujoco_module.mj_resetData(model, data)
        mujoco_module.mj_kinematics(model, data)
        yield data


def put_starts(data: Any, model: MjModel, arrays: Mapping[str, Varying], worlds: Sequence[int], state: bool) -> None:
    """Write the poses of fixed geoms into a `mujoco_warp.Data`, in place, and with `state` where worlds start.

    `arrays` has the values of these worlds, in this order.
    """
    names = [*_POSES, *(name for name in (_STATE if state else ()) if hasattr(data, name))]
    places: dict[str, Any] = dict.fromkeys(_POSES, fixed_geoms(model))
    rows = {name: getattr(data, name).numpy() for name in names if getattr(data, name).size}
    for world, host in zip(worlds, starts(model, arrays, len(worlds)), strict=True):
        for name, array in rows.items():
            at = places.get(name, slice(None))
            array[world, at] = getattr(host, name).reshape(array.shape[1:])[at]
    for name, array in rows.items():
        getattr(data, name).assign(array)
