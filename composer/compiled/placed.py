"""Compute all positions at a configuration, even for models that MuJoCo has no memory to simulate."""

from __future__ import annotations

from typing import Any

_PLACES = ("qpos", "mocap_pos", "mocap_quat")


def place(mujoco: Any, model: Any, data: Any) -> None:
    """Compute all positions; contacts too, unless MuJoCo runs out of memory for them.

    Looking for contacts of 10,000 bodies in the world needs 200 MB, and `mj_forward` has 16 MB unless `size/memory`
    says otherwise (MuJoCo 4.0).
    """
    try:
        mujoco.mj_forward(model, data)
        return
    except mujoco.FatalError:
        kept = {name: getattr(data, name).copy() for name in _PLACES}
    flags = int(model.opt.disableflags)
    mujoco.mj_resetData(model, data)
    for name, value in kept.items():
        getattr(data, name)[:] = value
    try:
        model.opt.disableflags = flags | int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        mujoco.mj_forward(model, data)
    finally:
        model.opt.disableflags = flags
