"""Convert MuJoCo's description of a compiled model to the index of a manifest."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from composer.bundle.manifest import Actuator, Camera, Index, Joint, Keyframe, Range, Sensor
from composer.compiled.joints import BY_WORD

if TYPE_CHECKING:
    from composer import engine

Written = Mapping[tuple[str, int], tuple[str, str]]
"""Tag and FILE:LINE of elements by kind (`joint`, `actuator`, `sensor`, `camera`, `key`) and number."""


def _range(pair: tuple[float, float] | None) -> Range | None:
    """Return a range with None for infinite ends, which JSON cannot represent."""
    if pair is None or not any(map(math.isfinite, pair)):
        return None
    low, high = (end if math.isfinite(end) else None for end in pair)
    return low, high


def index_of(index: engine.Index, written: Written | None = None) -> Index:
    """Return the manifest's index of a compiled model; `written` has the places of its elements."""
    known = written or {}

    def origin(kind: str, number: int) -> str | None:
        return known[kind, number][1] if (kind, number) in known else None

    return Index(
        joints=tuple(
            Joint(
                name=joint.name,
                type=joint.type,  # type: ignore[arg-type]  # pydantic checks the word
                body=joint.body,
                qpos=joint.qpos_address,
                qpos_size=joint.qpos_size,
                dof=joint.dof_address,
                dof_size=joint.dof_size,
                unit=BY_WORD[joint.type].unit,
                velocity_unit=BY_WORD[joint.type].velocity_unit,
                range=_range(joint.range if joint.limited else None),
                origin=origin("joint", number),
            )
            for number, joint in enumerate(index.joints)
        ),
        actuators=tuple(
            Actuator(
                name=actuator.name,
                type=known["actuator", number][0] if ("actuator", number) in known else None,
                ctrl=actuator.ctrl_address,
                ctrl_size=actuator.ctrl_size,
                act=actuator.act_address if actuator.act_size else None,
                act_size=actuator.act_size,
                unit=actuator.unit,
                ranges=tuple(map(_range, actuator.ctrl_ranges)),
                act_range=_range(actuator.act_range),
                force_range=_range(actuator.force_range),
                origin=origin("actuator", number),
            )
            for number, actuator in enumerate(index.actuators)
        ),
        sensors=tuple(
            Sensor(
                name=sensor.name,
                type=sensor.type,
                address=sensor.address,
                size=sensor.size,
                unit=sensor.unit,
                cutoff=None if sensor.cutoff == math.inf else sensor.cutoff,
                origin=origin("sensor", number),
            )
            for number, sensor in enumerate(index.sensors)
        ),
        cameras=tuple(
            Camera(
                name=camera.name,
                body=camera.body,
                fovy=camera.fovy,
                unit=camera.unit,  # type: ignore[arg-type]
                resolution=camera.resolution,
                origin=origin("camera", number),
            )
            for number, camera in enumerate(index.cameras)
        ),
        keyframes=tuple(
            Keyframe(name=key.name, time=key.time, origin=origin("key", number))
            for number, key in enumerate(index.keyframes)
        ),
    )
