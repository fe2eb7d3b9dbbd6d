"""Where everything is at a configuration, of models too that MuJoCo has no room to simulate."""

from __future__ import annotations

from typing import Any

_PLACES = ("qpos", "mocap_pos", "mocap_quat")


def place(mujoco: Any, model: Any, data: Any) -> None:
    """Compute all positions; contacts too, unless MuJoCo runs out of memory for them.

    10,000 bodies in the world need 200 MB to look for contacts, and `mj_forward` has 16 MB unless `size/memory` says
    otherwise (MuJoCo 4.0).
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
