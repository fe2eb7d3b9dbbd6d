"""The features of a data set of LeRobot, as its `meta/info.json` has them, for the motors and cameras of a model.

The names are those of LeRobot's own robots: the motor `left/elbow_flex` of a model is `left_elbow_flex.pos` there.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from mjcompose.base.sink import Sink
from mjcompose.base.words import counted
from mjcompose.mujoco.index import CompiledActuator, CompiledCamera
from mjcompose.sides.names import NamesRecord

_ENDS = {"rad": ".pos", "m": ".pos", "rad/s": ".vel", "m/s": ".vel", "N m": ".torque"}
"""The end of a motor's name in LeRobot, by the unit of its command; a motor with another unit has none."""
_UNSET = (1, 1)
"""The resolution of a camera whose file does not set one."""


def features(names: NamesRecord, sink: Sink) -> dict[str, Any] | None:
    """Return the features by name, or None after reported errors. Motors and cameras without a feature are warnings."""
    index = names.index
    if not index.actuators:
        message = "the model has no actuators, and a data set of LeRobot needs the feature `action`"
        sink.error("target-cannot", message, help="name a model with motors")
        return None
    nameless = sum(not motor.name for motor in index.actuators)
    if nameless:
        message = f"{counted(nameless, 'actuator')} without a name: a data set of LeRobot names each number"
        sink.error("target-cannot", message, help="give each actuator a `name`")
        return None
    vectors = {"observation.state": [*_positions(index.actuators, sink)], "action": [*_commands(index.actuators)]}
    images = [*_images(index.cameras, sink)]
    for vector, numbers in vectors.items():
        _check_unique(f"numbers of `{vector}`", numbers, sink)
    _check_unique("cameras", [f"observation.images.{name}" for name, _ in images], sink)
    if sink.has_errors:
        return None
    found = {name: _vector(numbers) for name, numbers in vectors.items() if numbers}
    return {**found, **{f"observation.images.{name}": _image(camera) for name, camera in images}}


def to_json(features: dict[str, Any]) -> str:
    return json.dumps(features, indent=2, ensure_ascii=False) + "\n"


def _positions(motors: Sequence[CompiledActuator], sink: Sink) -> Iterator[str]:
    """Yield the name of the position of each joint that a motor moves."""
    for joint in dict.fromkeys(motor.joint for motor in motors if motor.joint):
        yield f"{_own_name(joint)}.pos"
    others = [motor.name for motor in motors if not motor.joint]
    if others:
        message = f"`observation.state` has no number for {_listed('actuator', others)}"
        sink.warning("target-loss", message, help="only hinges and slides that a motor moves have one")


def _commands(motors: Sequence[CompiledActuator]) -> Iterator[str]:
    """Yield the name of the command of each motor."""
    for motor in motors:
        yield _own_name(motor.name) + _ENDS.get(motor.unit or "", "")


def _images(cameras: Sequence[CompiledCamera], sink: Sink) -> Iterator[tuple[str, CompiledCamera]]:
    """Yield the name and the camera of each image; a camera without a resolution is reported."""
    nameless = sum(not camera.name for camera in cameras)
    if nameless:
        of_these = "it" if nameless == 1 else "them"
        message = f"{counted(nameless, 'camera')} without a name: the data set has no images of {of_these}"
        sink.warning("target-loss", message, help="give each camera a `name`")
    unset = [camera.name for camera in cameras if camera.name and camera.resolution == _UNSET]
    if unset:
        message = f"{_listed('camera', unset)}: no resolution, so the data set has no images"
        help = f"set it in the recipe: `edit: [{{select: {{camera: {unset[0]}}}, set: {{resolution: [640, 480]}}}}]`"
        sink.warning("target-loss", message, help=help)
    for camera in cameras:
        if camera.name and camera.resolution != _UNSET:
            yield _own_name(camera.name), camera


def _own_name(name: str) -> str:
    """Return a name as LeRobot's robots have it: a `/` is not allowed there."""
    return name.replace("/", "_")


def _check_unique(elements: str, names: Sequence[str], sink: Sink) -> None:
    for name in (name for name, count in Counter(names).items() if count > 1):
        message = f"two {elements} would both be `{name}`, because LeRobot has `_` for the `/` of a name"
        sink.error("name-clash", message, help="`rename` one of them in the recipe")


def _listed(kind: str, names: Sequence[str]) -> str:
    return f"{kind} {', '.join(f'`{name}`' for name in names)}"


def _vector(names: list[str]) -> dict[str, Any]:
    return {"dtype": "float32", "shape": [len(names)], "names": names}


def _image(camera: CompiledCamera) -> dict[str, Any]:
    width, height = camera.resolution
    return {"dtype": "video", "shape": [height, width, 3], "names": ["height", "width", "channels"]}
