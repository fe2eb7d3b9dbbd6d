"""What is told of a compiled model. Runs in the child process; takes an mjModel, imports no MuJoCo itself.

Every attribute is one that MuJoCo 3.12 has; what came later is asked for with a fallback.
"""

from __future__ import annotations

from typing import Any

from composer.compiled import units

# kind of object -> the array of mjModel that says where its names start
NAME_ADDRESSES = {
    "body": "name_bodyadr",
    "joint": "name_jntadr",
    "geom": "name_geomadr",
    "site": "name_siteadr",
    "camera": "name_camadr",
    "light": "name_lightadr",
    "flex": "name_flexadr",
    "mesh": "name_meshadr",
    "skin": "name_skinadr",
    "hfield": "name_hfieldadr",
    "texture": "name_texadr",
    "material": "name_matadr",
    "pair": "name_pairadr",
    "exclude": "name_excludeadr",
    "equality": "name_eqadr",
    "tendon": "name_tendonadr",
    "actuator": "name_actuatoradr",
    "sensor": "name_sensoradr",
    "numeric": "name_numericadr",
    "text": "name_textadr",
    "tuple": "name_tupleadr",
    "key": "name_keyadr",
    "plugin": "name_pluginadr",
}

_JOINT_SIZES = {"free": (7, 6), "ball": (4, 3), "slide": (1, 1), "hinge": (1, 1)}

# sensors whose enum is not their tag in upper case
_SENSOR_TAGS = {
    "geomdist": "distance",
    "geomnormal": "normal",
    "geomfromto": "fromto",
    "jointactfrc": "jointactuatorfrc",
    "tendonactfrc": "tendonactuatorfrc",
}


def sizes(model: Any) -> dict[str, int]:
    """All integer sizes of the model; `nactuator` falls back to `nu`, which is the same before it existed."""
    found = {}
    for name in dir(model):
        if name.startswith("n"):
            value = getattr(model, name)
            if isinstance(value, int):
                found[name] = value
    found.setdefault("nactuator", found["nu"])
    return found


def names(model: Any, kind: str) -> list[str]:
    """The names of all objects of one kind, '' for those without; bytes that are no UTF-8 are replaced."""
    addresses = getattr(model, NAME_ADDRESSES[kind], ())
    text: bytes = model.names
    spans = [(int(start), text.index(b"\0", int(start))) for start in addresses]
    return [text[start:end].decode("utf-8", "replace") for start, end in spans]


def all_names(model: Any) -> dict[str, list[str]]:
    return {kind: names(model, kind) for kind in NAME_ADDRESSES}


def index(model: Any, mujoco: Any) -> dict[str, Any]:
    """The index as JSON-able data; addresses come as [start, count]."""
    bodies = names(model, "body")
    return {
        "joints": _joints(model, mujoco, bodies),
        "actuators": _actuators(model, mujoco),
        "sensors": _sensors(model, mujoco),
        "keyframes": [
            {"name": name, "time": float(model.key_time[row])} for row, name in enumerate(names(model, "key"))
        ],
        "cameras": _cameras(model, mujoco, bodies),
        "bodies": bodies,
    }


def _joints(model: Any, mujoco: Any, bodies: list[str]) -> list[dict[str, Any]]:
    members = mujoco.mjtJoint.__members__
    types = {int(value): word.removeprefix("mjJNT_").lower() for word, value in members.items()}
    rows = []
    for row, name in enumerate(names(model, "joint")):
        kind = types[int(model.jnt_type[row])]
        qpos_size, dof_size = _JOINT_SIZES[kind]
        rows.append(
            {
                "name": name,
                "type": kind,
                "qpos": [int(model.jnt_qposadr[row]), qpos_size],
                "dof": [int(model.jnt_dofadr[row]), dof_size],
                "limited": bool(model.jnt_limited[row]),
                "range": _bounds(model.jnt_range[row]),
                "body": bodies[int(model.jnt_bodyid[row])],
            }
        )
    return rows


def _actuators(model: Any, mujoco: Any) -> list[dict[str, Any]]:
    found = names(model, "actuator")
    ctrl_start = getattr(model, "actuator_ctrladr", range(len(found)))
    ctrl_count = getattr(model, "actuator_ctrlnum", [1] * len(found))
    rows = []
    for row, name in enumerate(found):
        start, count = int(ctrl_start[row]), int(ctrl_count[row])
        limited, bounds = model.actuator_ctrllimited, model.actuator_ctrlrange
        rows.append(
            {
                "name": name,
                "ctrl": [start, count],
                "act": [int(model.actuator_actadr[row]), int(model.actuator_actnum[row])],
                "unit": units.of_control(model, mujoco, row) if count == 1 else None,
                "ctrl_ranges": [
                    _bounds(bounds[each]) if limited[each] else None for each in range(start, start + count)
                ],
                "act_range": _bounds(model.actuator_actrange[row])
                if model.actuator_actlimited[row]
                else None,
                "force_range": _bounds(model.actuator_forcerange[row])
                if model.actuator_forcelimited[row]
                else None,
            }
        )
    return rows


def _bounds(pair: Any) -> list[float]:
    return [float(bound) for bound in pair]


def _sensors(model: Any, mujoco: Any) -> list[dict[str, Any]]:
    types = {}
    for word, value in mujoco.mjtSensor.__members__.items():
        tag = word.removeprefix("mjSENS_").lower()
        types[int(value)] = _SENSOR_TAGS.get(tag, tag)
    rows = []
    for row, name in enumerate(names(model, "sensor")):
        tag, size = types.get(int(model.sensor_type[row]), "unknown"), int(model.sensor_dim[row])
        cutoff = float(model.sensor_cutoff[row])
        rows.append(
            {
                "name": name,
                "type": tag,
                "data": [int(model.sensor_adr[row]), size],
                "unit": units.of_sensor(
                    tag, size, _coordinate(model, mujoco, tag, int(model.sensor_objid[row]))
                ),
                "cutoff": cutoff if cutoff > 0 else None,
            }
        )
    return rows


def _coordinate(model: Any, mujoco: Any, tag: str, row: int) -> str | None:
    """The unit of the coordinate of the joint or actuator that a sensor is on."""
    if tag.startswith("actuator"):
        return units.of_transmission(model, mujoco, row)
    if tag.startswith("joint"):
        members = mujoco.mjtJoint.__members__
        types = {int(value): word.removeprefix("mjJNT_").lower() for word, value in members.items()}
        return units.of_coordinate(types[int(model.jnt_type[row])])
    return None


def _cameras(model: Any, mujoco: Any, bodies: list[str]) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "body": bodies[int(model.cam_bodyid[row])],
            "fovy": float(model.cam_fovy[row]),
            "unit": units.LENGTH if _is_orthographic(model, mujoco, row) else "deg",
            "resolution": [int(each) for each in model.cam_resolution[row]],
        }
        for row, name in enumerate(names(model, "camera"))
    ]


def _is_orthographic(model: Any, mujoco: Any, row: int) -> bool:
    """In such a camera `fovy` is a length. Older versions have a flag, newer ones a kind of projection."""
    if hasattr(model, "cam_projection"):
        return int(model.cam_projection[row]) == int(mujoco.mjtProjection.mjPROJ_ORTHOGRAPHIC)
    return bool(getattr(model, "cam_orthographic", [0] * (row + 1))[row])


def arrays(wanted: list[str], model: Any, data: Any) -> dict[str, Any]:
    """The wanted arrays; a size comes as an array of one, text as its bytes.

    A name this version does not have is left out.
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
