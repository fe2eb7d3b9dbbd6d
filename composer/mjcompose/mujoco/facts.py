"""Sizes, names, positions and contacts of a compiled model, read in the child process. Imports no MuJoCo itself.

All attributes exist in MuJoCo 3.12; newer ones are read with a fallback.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from mjcompose.mujoco.attributes import KINDS, names


def save_digits(mujoco: Any, count: int = 17) -> None:
    """Set how many digits MuJoCo saves in this process; with 17, numbers read back to the same bits.

    It saves six by default. Raises ValueError for a version that cannot save more.
    """
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco*.so*", "libmujoco*.dylib", "mujoco*.dll"):
        for library in folder.glob(pattern):
            ctypes.CDLL(str(library))._mjPRIVATE__set_xml_precision(count)
            return
    raise ValueError("this version of MuJoCo saves rounded numbers only")


def sizes(model: Any) -> dict[str, int]:
    """Return all integer sizes of the model; `nactuator` falls back to `nu`, which is the same in older versions."""
    values = {name: getattr(model, name) for name in dir(model) if name.startswith("n")}
    found = {name: value for name, value in values.items() if isinstance(value, int)}
    return {**found, "nactuator": found.get("nactuator", found["nu"])}


def all_names(model: Any) -> dict[str, list[str]]:
    return {kind: names(model, kind) for kind in KINDS}


def arrays(wanted: list[str], model: Any, data: Any) -> dict[str, Any]:
    """Return the requested arrays; a size becomes an array of one, text its bytes.

    Names that this version does not have are missing.
    """
    import numpy

    found = {}
    for name in wanted:
        owner, _, attribute = name.rpartition(".")
        value = getattr(data if owner == "data" else model, attribute, None)
        if isinstance(value, bytes):
            value = numpy.frombuffer(value, numpy.uint8)
        if isinstance(value, int | float | numpy.ndarray):
            found[name] = numpy.atleast_1d(value)
    return found


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
