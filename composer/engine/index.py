"""Where the things that users address sit in the vectors of a compiled model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


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
    """An actuator without activation has `act_address` -1 and `act_size` 0."""

    name: str
    ctrl_address: int
    ctrl_size: int
    act_address: int
    act_size: int


@dataclass(frozen=True, slots=True)
class Sensor:
    """`type` is the tag MJCF has for it."""

    name: str
    type: str
    address: int
    size: int


@dataclass(frozen=True, slots=True)
class Index:
    """Everything in the order of the compiled model; unnamed things have the name ''."""

    joints: tuple[Joint, ...]
    actuators: tuple[Actuator, ...]
    sensors: tuple[Sensor, ...]
    keyframes: tuple[str, ...]
    cameras: tuple[str, ...]
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
                Actuator(entry["name"], *entry["ctrl"], *entry["act"]) for entry in data["actuators"]
            ),
            sensors=tuple(Sensor(entry["name"], entry["type"], *entry["data"]) for entry in data["sensors"]),
            keyframes=tuple(data["keyframes"]),
            cameras=tuple(data["cameras"]),
            bodies=tuple(data["bodies"]),
        )
