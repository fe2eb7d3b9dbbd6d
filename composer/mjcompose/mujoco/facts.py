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
    found = {}
    for name in dir(model):
        if name.startswith("n"):
            value = getattr(model, name)
            if isinstance(value, int):
                found[name] = value
    found.setdefault("nactuator", found["nu"])
    return found


def all_names(model: Any) -> dict[str, list[str]]:
    return {kind: names(model, kind) for kind in KINDS}


def arrays(wanted: list[str], model: Any, data: Any) -> dict[str, Any]:
    """Return the requested arrays; a size becomes an array of one, text its bytes.

    Names that this version does not have are left out.
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


_CLOSE = 1e-9


def touching(mujoco: Any, model: Any, prefixes: list[str]) -> list[dict[str, Any]]:
    """Return the pairs of bodies of different parts that touch or overlap; runs under `mjcompose.mujoco.engine.call`.

    This checks the reference configuration and all keys. `prefixes` are those of the parts. Freely floating bodies
    are left out, because they may lie on the other one. Each pair has the names of its `bodies` (empty for unnamed
    ones), their names for messages, and where they touch.
    """
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    model.opt.disableflags &= ~off
    explicit = {
        frozenset((int(one), int(other))) for one, other in zip(model.pair_geom1, model.pair_geom2, strict=True)
    }
    found: dict[tuple[int, int], dict[str, Any]] = {}
    for key in range(-1, model.nkey):
        data = mujoco.MjData(model)
        if key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_fwdPosition(model, data)
        for contact in data.contact:
            geoms = [int(each) for each in contact.geom]
            if contact.dist > _CLOSE or min(geoms) < 0 or frozenset(geoms) in explicit:
                continue
            one, other = sorted(int(model.geom_bodyid[each]) for each in geoms)
            parts = [_part(model, body, prefixes) for body in (one, other)]
            if parts[0] == parts[1] or (one, other) in found or _floats(mujoco, model, one, other=other):
                continue
            names = [model.body(body).name for body in (one, other)]
            called = [
                f"`{name}`" if name else f"a body in `{_named(model, body)}`"
                for name, body in zip(names, (one, other), strict=True)
            ]
            where = "the reference configuration" if key < 0 else f"the key `{model.key(key).name}`"
            found[one, other] = {"bodies": names, "called": called, "where": where}
    return list(found.values())


def _named(model: Any, body: int) -> str:
    while body and not model.body(body).name:
        body = int(model.body_parentid[body])
    return str(model.body(body).name)


def _part(model: Any, body: int, prefixes: list[str]) -> str:
    name = _named(model, body)
    return max((each for each in prefixes if name.startswith(each)), key=len, default="")


def _floats(mujoco: Any, model: Any, one: int, other: int) -> bool:
    """Return whether only a free joint connects the two."""
    roots = [int(model.body_rootid[body]) for body in (one, other)]
    if roots[0] == roots[1]:
        return False
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    return any(
        int(model.jnt_type[model.body_jntadr[root] + joint]) == free
        for root in roots
        for joint in range(int(model.body_jntnum[root]))
    )
