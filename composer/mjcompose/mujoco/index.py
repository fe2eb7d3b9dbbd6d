"""The addresses in a compiled model of everything that users address."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

from mjcompose.base.dataclass import dataclass
from mjcompose.mujoco import controls as units
from mjcompose.mujoco.addresses import rows_of, span
from mjcompose.mujoco.arrays import HINGE, JOINT_TYPES, LENGTH, words
from mjcompose.mujoco.attributes import Model, holder, names
from mjcompose.mujoco.controls import AFFINE, is_by_plugin
from mjcompose.mujoco.references import ON_JOINTS

Range: TypeAlias = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint. `range` is in MuJoCo's units (radians, metres) and only valid if `limited`."""

    name: str
    type: str
    qpos_address: int
    qpos_size: int
    dof_address: int
    dof_size: int
    limited: bool
    range: tuple[float, float]
    body: str


@dataclass(frozen=True, slots=True)
class Actuator:
    """An actuator without activation has `act_address` -1 and `act_size` 0.

    `unit` is that of its only control; `ctrl_ranges` has a range or None for each control, in that unit.
    """

    name: str
    ctrl_address: int
    ctrl_size: int
    act_address: int
    act_size: int
    unit: str | None = None
    ctrl_ranges: tuple[Range | None, ...] = ()
    act_range: Range | None = None
    force_range: Range | None = None
    stiffness: float = 0.0
    """The stiffness of a servo at its hinge, in N·m/rad; 0 for any other actuator."""


@dataclass(frozen=True, slots=True)
class Sensor:
    """A sensor. `type` is its MJCF tag; `cutoff`, in its unit, is None if there is no cutoff."""

    name: str
    type: str
    address: int
    size: int
    unit: str | None = None
    cutoff: float | None = None


@dataclass(frozen=True, slots=True)
class Camera:
    """The field of view and the resolution of a camera.

    `fovy` is in degrees, or in metres for an orthographic camera, as `unit` says; `resolution` is width and height.
    """

    name: str
    body: str
    fovy: float
    unit: str
    resolution: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A keyframe. `time` is in seconds."""

    name: str
    time: float


@dataclass(frozen=True, slots=True)
class Index:
    """Everything in the order of the compiled model; unnamed elements have the name ''."""

    joints: tuple[Joint, ...]
    actuators: tuple[Actuator, ...]
    sensors: tuple[Sensor, ...]
    keyframes: tuple[Keyframe, ...]
    cameras: tuple[Camera, ...]
    bodies: tuple[str, ...]

    @staticmethod
    def from_data(data: Mapping[str, Any]) -> Index:
        """Return the index for the JSON data from the child process."""
        return Index(
            joints=tuple(
                Joint(
                    name=entry["name"], type=entry["type"], qpos_address=entry["qpos"][0],
                    qpos_size=entry["qpos"][1], dof_address=entry["dof"][0], dof_size=entry["dof"][1],
                    limited=entry["limited"], range=(entry["range"][0], entry["range"][1]),
                    body=entry["body"],
                )
                for entry in data["joints"]
            ),
            actuators=tuple(
                Actuator(
                    name=entry["name"], ctrl_address=entry["ctrl"][0], ctrl_size=entry["ctrl"][1],
                    act_address=entry["act"][0], act_size=entry["act"][1], unit=entry["unit"],
                    ctrl_ranges=tuple(map(_range, entry["ctrl_ranges"])),
                    act_range=_range(entry["act_range"]), force_range=_range(entry["force_range"]),
                    stiffness=entry["stiffness"],
                )
                for entry in data["actuators"]
            ),
            sensors=tuple(
                Sensor(
                    name=entry["name"], type=entry["type"], address=entry["data"][0], size=entry["data"][1],
                    unit=entry["unit"], cutoff=entry["cutoff"],
                )
                for entry in data["sensors"]
            ),
            keyframes=tuple(Keyframe(entry["name"], entry["time"]) for entry in data["keyframes"]),
            cameras=tuple(
                Camera(
                    entry["name"], entry["body"], entry["fovy"], unit=entry["unit"],
                    resolution=(entry["resolution"][0], entry["resolution"][1]),
                )
                for entry in data["cameras"]
            ),
            bodies=tuple(data["bodies"]),
        )  # fmt: skip


def _range(bounds: list[float] | None) -> Range | None:
    return None if bounds is None else (bounds[0], bounds[1])


def index(model: Model, mujoco: Any) -> dict[str, Any]:
    """Return the index of a compiled model as JSON data; addresses are [start, count]. Runs in the child process."""
    bodies = names(model, "body")
    return {
        "joints": _joints(model, bodies),
        "actuators": _actuators(model, mujoco),
        "sensors": _sensors(model, mujoco),
        "keyframes": [
            {"name": name, "time": float(model.key_time[row])} for row, name in enumerate(names(model, "key"))
        ],
        "cameras": _cameras(model, mujoco, bodies),
        "bodies": bodies,
    }


def _joints(model: Model, bodies: list[str]) -> list[dict[str, Any]]:
    rows = []
    for row, name in enumerate(names(model, "joint")):
        rows.append(
            {
                "name": name,
                "type": JOINT_TYPES[int(model.jnt_type[row])].word,
                "qpos": _span(span(model, "qpos", row)),
                "dof": _span(span(model, "qvel", row)),
                "limited": bool(model.jnt_limited[row]),
                "range": _bounds(model.jnt_range[row]),
                "body": bodies[holder(model, "joint", row)],
            }
        )
    return rows


def _actuators(model: Model, mujoco: Any) -> list[dict[str, Any]]:
    rows = []
    for row, name in enumerate(names(model, "actuator")):
        controls = span(model, "ctrl", row)
        limited, bounds = model.actuator_ctrllimited, model.actuator_ctrlrange
        rows.append(
            {
                "name": name,
                "ctrl": _span(controls),
                "act": _span(span(model, "act", row), -1),
                "unit": units.of_control(model, mujoco, row) if len(controls) == 1 else None,
                "ctrl_ranges": [_bounds(bounds[each]) if limited[each] else None for each in controls],
                "stiffness": _stiffness(model, row),
                "act_range": _bounds(model.actuator_actrange[row])
                if model.actuator_actlimited[row]
                else None,
                "force_range": _bounds(model.actuator_forcerange[row])
                if model.actuator_forcelimited[row]
                else None,
            }
        )
    return rows


def _stiffness(model: Model, row: int) -> float:
    """Return the stiffness that a servo gives a hinge through its gear, in N·m/rad; 0 for any other actuator."""
    target = int(model.actuator_trnid[row, 0])
    if int(model.actuator_trntype[row]) not in ON_JOINTS or int(model.jnt_type[target]) != HINGE:
        return 0.0
    if is_by_plugin(model, row) or int(model.actuator_biastype[row]) != AFFINE:
        return 0.0
    gear = float(model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=row).start, 0])
    return -float(model.actuator_biasprm[row, 1]) * gear**2


def _span(rows: range, nowhere: int = 0) -> list[int]:
    """Return the first address and the count, which is 0 for `<dcmotor input="none">` and `<user dim="0">`."""
    return [rows.start if rows else nowhere, len(rows)]


def _bounds(pair: Any) -> list[float]:
    return [float(bound) for bound in pair]


def _sensors(model: Model, mujoco: Any) -> list[dict[str, Any]]:
    tags = words(mujoco, "sensor_type")
    rows = []
    for row, name in enumerate(names(model, "sensor")):
        tag, size = tags.get(int(model.sensor_type[row]), "unknown"), int(model.sensor_dim[row])
        cutoff = float(model.sensor_cutoff[row])
        rows.append(
            {
                "name": name,
                "type": tag,
                "data": _span(span(model, "sensordata", row)),
                "unit": units.of_sensor(tag, size, _coordinate(model, tag, int(model.sensor_objid[row]))),
                "cutoff": cutoff if cutoff > 0 else None,
            }
        )
    return rows


def _coordinate(model: Model, tag: str, row: int) -> str | None:
    """Return the unit of the coordinate of a sensor's joint or actuator."""
    if tag.startswith("actuator"):
        return units.of_transmission(model, row)
    if tag.startswith("joint"):
        return JOINT_TYPES[int(model.jnt_type[row])].coordinate
    return None


def _cameras(model: Model, mujoco: Any, bodies: list[str]) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "body": bodies[holder(model, "camera", row)],
            "fovy": float(model.cam_fovy[row]),
            "unit": LENGTH if _is_orthographic(model, mujoco, row) else "deg",
            "resolution": [int(each) for each in model.cam_resolution[row]],
        }
        for row, name in enumerate(names(model, "camera"))
    ]


def _is_orthographic(model: Model, mujoco: Any, row: int) -> bool:
    """Return whether `fovy` is a length. Older versions have a flag, newer ones a projection type."""
    if hasattr(model, "cam_projection"):
        return int(model.cam_projection[row]) == int(mujoco.mjtProjection.mjPROJ_ORTHOGRAPHIC)
    return bool(getattr(model, "cam_orthographic", [0] * (row + 1))[row])
