"""Target: Drake. Its parser of MJCF reads bodies, joints, geoms, motors, position servos and `connect`."""

from __future__ import annotations

from mjcompose.targets import restrictions as limits
from mjcompose.targets.solver import BITS, COMPUTING, GRAVCOMP, SOFTNESS, unread_contacts
from mjcompose.targets.target import Target, write_mjcf

# Drake 1.51 uses the control range of a position servo, which is in radians, as the range of its torque. With
# `ctrllimited` alone, the torque is limited to zero, which it refuses.
_NO_CONTROL_RANGE = limits.without_attribute(
    "control ranges", "actuator/position", "ctrlrange", what="`ctrlrange`",
    why="the program would take it for the range of the force", also=("ctrllimited",),
)  # fmt: skip

TARGET = Target(
    "drake", "Drake, by its parser of MJCF", (
        limits.NO_REFERENCES, limits.SINGLE_JOINTS, limits.NO_EMPTY_INERTIA, limits.NO_KEYS, limits.NO_SENSORS,
        limits.NO_CAMERAS, limits.NO_LIGHTS, limits.NO_SITES, limits.NO_TENDONS, limits.NO_PAIRS, limits.NO_SOFT,
        limits.NO_PLUGINS, limits.NO_CUSTOM, limits.NO_POLYNOMIALS, limits.NO_SPRINGS, limits.NO_FRICTION,
        limits.NO_EFFORT, *limits.unread_in("free", "damping"), limits.no_shapes("hfield"), limits.NO_HIDDEN_SHAPES,
        limits.NO_TEXTURES, limits.servos("motor", "position"), _NO_CONTROL_RANGE, limits.AT_JOINTS,
        limits.SYMMETRIC_FORCES, limits.NO_SERVO_DAMPING, limits.NO_DELAY, limits.NO_ACTUATOR_ARMATURE,
        limits.NO_ACTUATOR_DAMPING, limits.REFLECTED_ARMATURE,
        limits.left_out("equality", "equality/*", but=("connect",), why="what they couple moves freely"),
        COMPUTING, GRAVCOMP, BITS, SOFTNESS, unread_contacts("torsional", "rolling"),
    ), write=write_mjcf, package="drake",
)  # fmt: skip
