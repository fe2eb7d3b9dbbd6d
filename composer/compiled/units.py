"""The units of the controls and sensors of a compiled model. Runs in the child process; imports no MuJoCo.

As in MuJoCo, angles are in radians and lengths in metres. The unit of a quaternion is the word itself; `1` is a
plain number; None means that the unit depends on the model's author.
"""

from __future__ import annotations

from typing import Any

from composer.compiled.addresses import rows_of
from composer.compiled.joints import ANGLE, JOINT_TYPES, LENGTH
from composer.compiled.kinds import Model
from composer.compiled.links import ON_JOINTS, ON_TENDON
from composer.compiled.servos import servo

FORCES = {ANGLE: "N m", LENGTH: "N"}
"""The unit of the force along a coordinate with that unit."""

_SENSORS = {
    "touch": "N",
    "accelerometer": "m/s^2",
    "velocimeter": "m/s",
    "gyro": "rad/s",
    "force": "N",
    "torque": "N m",
    "camprojection": "px",
    "tendonpos": "m",
    "tendonvel": "m/s",
    "tendonactuatorfrc": "N",
    "ballquat": "quaternion",
    "ballangvel": "rad/s",
    "tendonlimitpos": "m",
    "tendonlimitvel": "m/s",
    "tendonlimitfrc": "N",
    "framepos": "m",
    "framequat": "quaternion",
    "framexaxis": "1",
    "frameyaxis": "1",
    "framezaxis": "1",
    "framelinvel": "m/s",
    "frameangvel": "rad/s",
    "framelinacc": "m/s^2",
    "frameangacc": "rad/s^2",
    "subtreecom": "m",
    "subtreelinvel": "m/s",
    "subtreeangmom": "kg m^2/s",
    "insidesite": "1",
    "distance": "m",
    "normal": "1",
    "fromto": "m",
    "e_potential": "J",
    "e_kinetic": "J",
    "clock": "s",
}
_OF_JOINTS = {"pos": "{}", "vel": "{}/s", "frc": None}
"""The quantities that sensors of joints and actuators measure, by the suffix of their tag."""


def of_sensor(tag: str, dimension: int, about: str | None) -> str | None:
    """Return the unit of a sensor; `about` is the unit of the coordinate of its joint or actuator."""
    if tag == "rangefinder":
        return LENGTH if dimension == 1 else None  # with more fields it is more than a distance
    if not tag.startswith(("joint", "actuator")):
        return _SENSORS.get(tag)
    if about is None:
        return None
    form = _OF_JOINTS[tag[-3:]]
    return FORCES[about] if form is None else form.format(about)


def of_transmission(model: Model, row: int) -> str | None:
    """Return the unit of an actuator's length: that of its coordinate, unless a gear scales it."""
    kind, target = int(model.actuator_trntype[row]), int(model.actuator_trnid[row, 0])
    scale, *others = model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=row).start]
    if abs(scale) != 1 or any(others):
        return None
    if kind == ON_TENDON:
        return LENGTH
    if kind in ON_JOINTS:
        return JOINT_TYPES[int(model.jnt_type[target])].coordinate
    return None


def of_control(model: Model, mujoco: Any, row: int) -> str | None:
    """Return the unit of an actuator's only control, derived from MuJoCo's computations with it.

    A servo takes a position or a velocity, a motor a force or torque, a muscle an activation.
    """
    dynamics = int(model.actuator_dyntype[row])
    if dynamics == int(mujoco.mjtDyn.mjDYN_MUSCLE):
        return "1"
    about = of_transmission(model, row)
    gains = servo(model, row)
    if about is None or gains is None or dynamics >= int(mujoco.mjtDyn.mjDYN_USER):
        return None
    rate = "/s" if dynamics == int(mujoco.mjtDyn.mjDYN_INTEGRATOR) else ""
    if gains.get("kp", 0) > 0:
        return about + rate
    if rate:
        return None
    if gains.get("kv", 0) > 0:
        return f"{about}/s"
    return FORCES[about] if gains.get("gain") == 1 else None
