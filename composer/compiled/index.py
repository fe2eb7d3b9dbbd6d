"""Where the things that users address sit in the vectors of a compiled model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

Range: TypeAlias = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Joint:
    """`range` is as MuJoCo holds it (radians, metres) and means something only when `limited`."""

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

    `unit` is that of its only control, `ctrl_ranges` has a range or None for each control, in that unit.
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


@dataclass(frozen=True, slots=True)
class Sensor:
    """`type` is the tag MJCF has for it; `cutoff`, in its unit, is None where it cuts nothing off."""

    name: str
    type: str
    address: int
    size: int
    unit: str | None = None
    cutoff: float | None = None


@dataclass(frozen=True, slots=True)
class Camera:
    """`fovy` is in degrees, or metres for an orthographic camera, as `unit` says; `resolution` is width and height."""

    name: str
    body: str
    fovy: float
    unit: str
    resolution: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Keyframe:
    """`time` is in seconds."""

    name: str
    time: float


@dataclass(frozen=True, slots=True)
class Index:
    """Everything in the order of the compiled model; unnamed things have the name ''."""

    joints: tuple[Joint, ...]
    actuators: tuple[Actuator, ...]
    sensors: tuple[Sensor, ...]
    keyframes: tuple[Keyframe, ...]
    cameras: tuple[Camera, ...]
    bodies: tuple[str, ...]

    @staticmethod
    def from_data(data: Mapping[str, Any]) -> Index:
        """The index as the child process sends it, made from its JSON."""
        return Index(
            joints=tuple(
                Joint(
                    name=entry["name"],
                    type=entry["type"],
                    qpos_address=entry["qpos"][0],
                    qpos_size=entry["qpos"][1],
                    dof_address=entry["dof"][0],
                    dof_size=entry["dof"][1],
                    limited=entry["limited"],
                    range=(entry["range"][0], entry["range"][1]),
                    body=entry["body"],
                )
                for entry in data["joints"]
            ),
            actuators=tuple(
                Actuator(
                    name=entry["name"],
                    ctrl_address=entry["ctrl"][0],
                    ctrl_size=entry["ctrl"][1],
                    act_address=entry["act"][0],
                    act_size=entry["act"][1],
                    unit=entry["unit"],
                    ctrl_ranges=tuple(map(_range, entry["ctrl_ranges"])),
                    act_range=_range(entry["act_range"]),
                    force_range=_range(entry["force_range"]),
                )
                for entry in data["actuators"]
            ),
            sensors=tuple(
                Sensor(
                    name=entry["name"],
                    type=entry["type"],
                    address=entry["data"][0],
                    size=entry["data"][1],
                    unit=entry["unit"],
                    cutoff=entry["cutoff"],
                )
                for entry in data["sensors"]
            ),
            keyframes=tuple(Keyframe(entry["name"], entry["time"]) for entry in data["keyframes"]),
            cameras=tuple(
                Camera(
                    entry["name"],
                    entry["body"],
                    entry["fovy"],
                    entry["unit"],
                    (entry["resolution"][0], entry["resolution"][1]),
                )
                for entry in data["cameras"]
            ),
            bodies=tuple(data["bodies"]),
        )


def _range(bounds: list[float] | None) -> Range | None:
    return None if bounds is None else (bounds[0], bounds[1])
