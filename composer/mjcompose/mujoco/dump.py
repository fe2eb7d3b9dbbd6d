"""Compiles a model and writes down all that is in it. Runs by itself, in any Python with numpy and a MuJoCo since 3.0.

Its arguments are the path of a model and the path of the file to write. It prints the result as JSON.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from typing import Any
from xml.etree import ElementTree

_COUNTS = {
    "body": "nbody", "joint": "njnt", "geom": "ngeom", "site": "nsite", "camera": "ncam", "light": "nlight",
    "flex": "nflex", "mesh": "nmesh", "skin": "nskin", "hfield": "nhfield", "texture": "ntex", "material": "nmat",
    "pair": "npair", "exclude": "nexclude", "equality": "neq", "tendon": "ntendon", "actuator": ("nactuator", "nu"),
    "sensor": "nsensor", "numeric": "nnumeric", "text": "ntext", "tuple": "ntuple", "key": "nkey", "plugin": "nplugin",
}  # fmt: skip


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
            arrays = dict(_arrays(model, numpy))
            said["names"] = _names(model, mujoco)
            said["words"] = {**_words(model, mujoco), "marks": _marks(model, mujoco, sys.argv[2] + ".xml")}
            with open(sys.argv[2], "wb") as out:
                numpy.savez(out, **arrays)
    json.dump(said, sys.stdout)


def _arrays(model: Any, numpy: Any) -> Iterator[tuple[str, Any]]:
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


def _names(model: Any, mujoco: Any) -> dict[str, Any]:
    found = {}
    for kind, counts in _COUNTS.items():
        several = counts if isinstance(counts, tuple) else (counts,)
        count = next((getattr(model, each) for each in several if hasattr(model, each)), 0)
        type = getattr(mujoco.mjtObj, "mjOBJ_" + kind.upper(), None)
        if type is not None:
            found[kind] = [mujoco.mj_id2name(model, type.value, index) for index in range(count)]
    return found


def _words(model: Any, mujoco: Any) -> dict[str, Any]:
    """Flags and kinds by their names, for the numbers behind them are not the same in all versions."""
    found: dict[str, Any] = {"flags": {}}
    for prefix, kind, bits in (
        ("mjDSBL_", "mjtDisableBit", ~int(model.opt.disableflags)),
        ("mjENBL_", "mjtEnableBit", int(model.opt.enableflags)),
    ):
        for name in dir(getattr(mujoco, kind)):
            if name.startswith(prefix):
                bit = int(getattr(getattr(mujoco, kind), name))
                found["flags"][name[len(prefix) :].lower()] = bool(bits & bit)
    for array, kind in _KINDS.items():
        value = getattr(model.opt, array[4:]) if array.startswith("opt.") else getattr(model, array, None)
        if value is None or not hasattr(mujoco, kind):
            continue
        meant = {int(getattr(getattr(mujoco, kind), name)): name for name in dir(getattr(mujoco, kind))
                 if name.startswith("mj")}  # fmt: skip
        flat = value.ravel() if hasattr(value, "ravel") else [value]
        found[array] = [meant.get(int(each), str(int(each))) for each in flat]
    return found


def _marks(model: Any, mujoco: Any, saved: str) -> list[list[int] | None]:
    """The color of the random marks of each texture, or None for one without: the text alone knows."""
    mujoco.mj_saveLastXML(saved, model)
    parser = ElementTree.XMLParser(encoding="utf-8")  # nosec B314  # MuJoCo wrote the text, without a document type
    textures = ElementTree.parse(saved, parser).iterfind("asset/texture")  # nosec B314
    return [
        [int(255 * float(each)) for each in texture.get("markrgb", "0 0 0").split()]
        if texture.get("mark") == "random"
        else None
        for texture in textures
    ]


_KINDS = {
    "jnt_type": "mjtJoint", "geom_type": "mjtGeom", "site_type": "mjtGeom", "cam_mode": "mjtCamLight",
    "light_mode": "mjtCamLight", "light_type": "mjtLightType", "tex_type": "mjtTexture", "eq_type": "mjtEq",
    "eq_objtype": "mjtObj", "wrap_type": "mjtWrap", "actuator_trntype": "mjtTrn", "actuator_dyntype": "mjtDyn",
    "actuator_gaintype": "mjtGain", "actuator_biastype": "mjtBias", "sensor_type": "mjtSensor",
    "sensor_datatype": "mjtDataType", "sensor_needstage": "mjtStage", "sensor_objtype": "mjtObj",
    "sensor_reftype": "mjtObj", "tuple_objtype": "mjtObj", "opt.integrator": "mjtIntegrator",
    "opt.cone": "mjtCone", "opt.jacobian": "mjtJacobian", "opt.solver": "mjtSolver",
}  # fmt: skip


if __name__ == "__main__":
    main()
