"""The units of what a compiled model measures and is told. Runs in the child process; imports no MuJoCo.

Angles are radians, lengths metres, as MuJoCo holds them. A quaternion has no unit and is called one; `1` is a plain
number; None where the unit depends on what the model means by it.
"""

from __future__ import annotations

from typing import Any

from composer.engine.actuator_rows import first_row

ANGLE, LENGTH = "rad", "m"
FORCES = {ANGLE: "N m", LENGTH: "N"}
"""What acts along a coordinate of that unit."""

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
"""What sensors of joints and actuators measure, by the end of their tag."""


def of_coordinate(joint: str) -> str | None:
    """The unit of a joint's position; None for those that have several."""
    return {"hinge": ANGLE, "slide": LENGTH}.get(joint)


def of_sensor(tag: str, dimension: int, about: str | None) -> str | None:
    """The unit of a sensor; `about` is that of the coordinate of the joint or actuator that it is on."""
    if tag == "rangefinder":
        return LENGTH if dimension == 1 else None  # with more fields it says more than a distance
    if not tag.startswith(("joint", "actuator")):
        return _SENSORS.get(tag)
    if about is None:
        return None
    form = _OF_JOINTS[tag[-3:]]
    return FORCES[about] if form is None else form.format(about)


def of_transmission(model: Any, mujoco: Any, row: int) -> str | None:
    """The unit of an actuator's length: that of the coordinate it acts on, unless a gear scales it."""
    kinds = mujoco.mjtTrn
    kind, target = int(model.actuator_trntype[row]), int(model.actuator_trnid[row, 0])
    scale, *others = model.actuator_gear[first_row(model, "actuator_gear", row)]
    if abs(scale) != 1 or any(others):
        return None
    if kind == int(kinds.mjTRN_TENDON):
        return LENGTH
    if kind in (int(kinds.mjTRN_JOINT), int(kinds.mjTRN_JOINTINPARENT)):
        types = mujoco.mjtJoint
        joint = int(model.jnt_type[target])
        return {int(types.mjJNT_HINGE): ANGLE, int(types.mjJNT_SLIDE): LENGTH}.get(joint)
    return None


def of_control(model: Any, mujoco: Any, row: int) -> str | None:
    """The unit of an actuator's only control, told from what MuJoCo computes with it.

    A servo wants a position or a velocity, a motor a force or torque, a muscle an activation.
    """
    dynamics = int(model.actuator_dyntype[row])
    if dynamics == int(mujoco.mjtDyn.mjDYN_MUSCLE):
        return "1"
    about = of_transmission(model, mujoco, row)
    fixed = int(model.actuator_gaintype[row]) == int(mujoco.mjtGain.mjGAIN_FIXED)
    if about is None or not fixed or dynamics >= int(mujoco.mjtDyn.mjDYN_USER):
        return None
    gain = float(model.actuator_gainprm[row, 0])
    bias = [float(each) for each in model.actuator_biasprm[row, :3]]
    rate = "/s" if dynamics == int(mujoco.mjtDyn.mjDYN_INTEGRATOR) else ""
    kind = int(model.actuator_biastype[row])
    if kind == int(mujoco.mjtBias.mjBIAS_AFFINE) and gain > 0 and bias[0] == 0:
        if bias[1] == -gain:
            return about + rate
        if bias[1] == 0 and bias[2] == -gain and not rate:
            return f"{about}/s"
    if kind == int(mujoco.mjtBias.mjBIAS_NONE) and gain == 1 and not rate:
        return FORCES[about]
    return None
