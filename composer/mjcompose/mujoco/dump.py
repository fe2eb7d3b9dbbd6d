"""Compiles a model and writes all of its arrays, or its motion, to a file. It prints the rest as JSON.

It runs by itself, in any Python with numpy and a MuJoCo since 3.0. Its arguments are the path of a model, the path of
the file to write and, for the motion, a request as JSON: the `seconds`, the names of the `trials`, and the `key` to
start from, if any. For the motion, the file has the positions of all joints and bodies at equal times, as `qpos-N` and
`xpos-N` for trial N.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_COUNTS = {
    "body": "nbody",
    "joint": "njnt",
    "geom": "ngeom",
    "site": "nsite",
    "camera": "ncam",
    "light": "nlight",
    "flex": "nflex",
    "mesh": "nmesh",
    "skin": "nskin",
    "hfield": "nhfield",
    "texture": "ntex",
    "material": "nmat",
    "pair": "npair",
    "exclude": "nexclude",
    "equality": "neq",
    "tendon": "ntendon",
    "actuator": ("nactuator", "nu"),
    "sensor": "nsensor",
    "numeric": "nnumeric",
    "text": "ntext",
    "tuple": "ntuple",
    "key": "nkey",
    "plugin": "nplugin",
}


def main() -> None:
    import mujoco
    import numpy

    said: dict[str, Any] = {"version": mujoco.__version__}
    if len(sys.argv) > 2:
        try:
            model = mujoco.MjModel.from_xml_path(sys.argv[1])
        except Exception as error:
            said["error"] = str(error)
        else:
            if len(sys.argv) > 3:
                arrays = _motion(mujoco, model, json.loads(sys.argv[3]), said=said)
            else:
                arrays = dict(_arrays(model, numpy))
                said["names"] = _names(model, mujoco)
                said["words"] = {**_words(model, mujoco), "marks": _marks(model, mujoco, sys.argv[2] + ".xml")}
            with open(sys.argv[2], "wb") as out:
                numpy.savez(out, **arrays)
    json.dump(said, sys.stdout)


def _arrays(model: MjModel, numpy: Any) -> Iterator[tuple[str, Any]]:
    for name in dir(model):
        if name.startswith("_") or name in ("names", "paths", "text_data", "signature"):
            continue
        value = getattr(model, name)
        if name in ("opt", "stat"):
            yield from _members(name, value, numpy)
        elif name == "vis":
            for group in dir(value):
                if not group.startswith("_") and not callable(getattr(value, group)):
                    yield from _members("vis." + group.rstrip("_"), getattr(value, group), numpy)
        elif isinstance(value, numpy.ndarray) or (isinstance(value, int) and name.startswith(("n", "flg_"))):
            yield name, numpy.asarray(value)


def _members(prefix: str, struct: Any, numpy: Any) -> Iterator[tuple[str, Any]]:
    for name in dir(struct):
        if name.startswith("_") or callable(getattr(struct, name)):
            continue
        array = numpy.asarray(getattr(struct, name))
        if array.dtype.kind in "bifu":
            yield prefix + "." + name, array


def _names(model: MjModel, mujoco: Any) -> dict[str, Any]:
    found = {}
    for kind, counts in _COUNTS.items():
        several = counts if isinstance(counts, tuple) else (counts,)
        count = next((getattr(model, each) for each in several if hasattr(model, each)), 0)
        type = getattr(mujoco.mjtObj, "mjOBJ_" + kind.upper(), None)
        if type is not None:
            found[kind] = [mujoco.mj_id2name(model, type.value, index) for index in range(count)]
    return found


def _words(model: MjModel, mujoco: Any) -> dict[str, Any]:
    """Flags and kinds by their names, because their numbers differ between versions."""
    found: dict[str, Any] = {"flags": {}}
    off = int(model.opt.disableflags)
    on = int(model.opt.enableflags)
    for prefix, kind, bits in (("mjDSBL_", "mjtDisableBit", ~off), ("mjENBL_", "mjtEnableBit", on)):
        for name in dir(getattr(mujoco, kind)):
            if name.startswith(prefix):
                bit = int(getattr(getattr(mujoco, kind), name))
                found["flags"][name[len(prefix) :].lower()] = bool(bits & bit)
    for array, kind in _KINDS.items():
        value = getattr(model.opt, array[4:]) if array.startswith("opt.") else getattr(model, array, None)
        if value is None or not hasattr(mujoco, kind):
            continue
        meant = {
            int(getattr(getattr(mujoco, kind), name)): name
            for name in dir(getattr(mujoco, kind))
            if name.startswith("mj")
        }
        flat = value.ravel() if hasattr(value, "ravel") else [value]
        found[array] = [meant.get(int(each), str(int(each))) for each in flat]
    return found


def _marks(model: MjModel, mujoco: Any, saved: str) -> list[list[int] | None]:
    """The color of the random marks of each texture, or None for a texture without marks; only the text has it."""
    mujoco.mj_saveLastXML(saved, model)
    parser = ElementTree.XMLParser(encoding="utf-8")  # nosec B314  # MuJoCo wrote the text, without a document type
    textures = ElementTree.parse(saved, parser).iterfind("asset/texture")  # nosec B314
    colors = [texture.get("markrgb", "0 0 0") if texture.get("mark") == "random" else None for texture in textures]
    return [None if color is None else [int(255 * float(each)) for each in color.split()] for color in colors]


_KINDS = {
    "jnt_type": "mjtJoint",
    "geom_type": "mjtGeom",
    "site_type": "mjtGeom",
    "cam_mode": "mjtCamLight",
    "light_mode": "mjtCamLight",
    "light_type": "mjtLightType",
    "tex_type": "mjtTexture",
    "eq_type": "mjtEq",
    "eq_objtype": "mjtObj",
    "wrap_type": "mjtWrap",
    "actuator_trntype": "mjtTrn",
    "actuator_dyntype": "mjtDyn",
    "actuator_gaintype": "mjtGain",
    "actuator_biastype": "mjtBias",
    "sensor_type": "mjtSensor",
    "sensor_datatype": "mjtDataType",
    "sensor_needstage": "mjtStage",
    "sensor_objtype": "mjtObj",
    "sensor_reftype": "mjtObj",
    "tuple_objtype": "mjtObj",
    "opt.integrator": "mjtIntegrator",
    "opt.cone": "mjtCone",
    "opt.jacobian": "mjtJacobian",
    "opt.solver": "mjtSolver",
}


_FRAMES = 50
_STEP = 0.1
"""The step of a control, as a share of its range or in its own unit."""
_LIFT = 0.05
"""The height of a drop, in meters."""
_MOST_STEPS = 1_000_000


def _motion(mujoco: Any, model: MjModel, asked: dict[str, Any], said: dict[str, Any]) -> dict[str, Any]:
    """Return the arrays of all trials, and note their names; none if the key does not exist."""
    arrays: dict[str, Any] = {}
    said["keys"] = [_name(mujoco, model, "KEY", number=n) for n in range(model.nkey)]
    said["trials"] = []
    said["diverged"] = []
    if asked["key"] is not None and asked["key"] not in said["keys"]:
        return arrays
    for name, data in _trials(mujoco, model, asked, keys=said["keys"]):
        rows = [[data.qpos.copy(), data.xpos.copy()] for _ in _frames(mujoco, model, data, seconds=asked["seconds"])]
        flags = ("mjWARN_BADQPOS", "mjWARN_BADQVEL", "mjWARN_BADQACC")
        if any(data.warning[int(getattr(mujoco.mjtWarning, flag))].number for flag in flags):
            said["diverged"].append(name)
        for kind, each in zip(("qpos", "xpos"), zip(*rows, strict=True), strict=True):
            arrays[f"{kind}-{len(said['trials'])}"] = each
        said["trials"].append(name)
    said["joints"] = [
        [_name(mujoco, model, "JOINT", number=n), int(model.jnt_type[n]), int(model.jnt_qposadr[n])]
        for n in range(model.njnt)
    ]
    said["bodies"] = [_name(mujoco, model, "BODY", number=n) for n in range(model.nbody)]
    arrays["inertias"] = [[model.body_mass[n], *model.body_inertia[n], *model.body_ipos[n]] for n in range(model.nbody)]
    return arrays


def _name(mujoco: Any, model: MjModel, kind: str, number: int) -> str:
    return str(mujoco.mj_id2name(model, getattr(mujoco.mjtObj, "mjOBJ_" + kind).value, number) or f"#{number}")


def _trials(mujoco: Any, model: MjModel, asked: dict[str, Any], keys: list[str]) -> Iterator[tuple[str, Any]]:
    """Yield each trial with its start: settle from the reference, hold a key, a step of all controls, or a drop."""
    start = keys.index(asked["key"]) if asked["key"] in keys else 0
    flags = int(model.opt.disableflags)
    for trial in asked["trials"]:
        data = mujoco.MjData(model)
        if trial != "settle" and keys:
            mujoco.mj_resetDataKeyframe(model, data, start)
        elif trial == "hold":
            continue
        if trial == "step":
            if not len(data.ctrl):
                continue
            _step_controls(model, data)
        if trial == "drop":
            model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
            _lift(model, data)
        yield f"{trial} {keys[start]}" if trial != "settle" and keys else trial, data
        model.opt.disableflags = flags


def _step_controls(model: MjModel, data: MjData) -> None:
    """Add a share of its range to each control."""
    ends = model.actuator_ctrlrange
    widths = [high - low if on else 1.0 for on, (low, high) in zip(model.actuator_ctrllimited, ends, strict=True)]
    data.ctrl[: len(widths)] += [_STEP * width for width in widths]


def _lift(model: MjModel, data: MjData) -> None:
    """Lift all free bodies."""
    for joint in range(model.njnt):
        if not model.jnt_type[joint]:
            data.qpos[model.jnt_qposadr[joint] + 2] += _LIFT


def _frames(mujoco: Any, model: MjModel, data: MjData, seconds: float) -> Iterator[int]:
    steps = min(max(1, round(seconds / model.opt.timestep)), _MOST_STEPS)
    mujoco.mj_kinematics(model, data)
    for frame in range(_FRAMES):
        for _ in range(steps * frame // _FRAMES, steps * (frame + 1) // _FRAMES):
            mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)
        yield frame


if __name__ == "__main__":
    main()
