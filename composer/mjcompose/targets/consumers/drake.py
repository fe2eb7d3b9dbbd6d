"""Target: Drake. Its parser of MJCF reads bodies, joints, geoms, motors, position servos and `connect`."""

from __future__ import annotations

from mjcompose.targets.restrictions import (
    AT_JOINTS,
    NO_ACTUATOR_ARMATURE,
    NO_ACTUATOR_DAMPING,
    NO_CAMERAS,
    NO_CUSTOM,
    NO_DELAY,
    NO_EFFORT,
    NO_EMPTY_INERTIA,
    NO_FRICTION,
    NO_HIDDEN_SHAPES,
    NO_KEYS,
    NO_LIGHTS,
    NO_PAIRS,
    NO_PLUGINS,
    NO_POLYNOMIALS,
    NO_REFERENCES,
    NO_SENSORS,
    NO_SERVO_DAMPING,
    NO_SITES,
    NO_SOFT,
    NO_SPRINGS,
    NO_TENDONS,
    NO_TEXTURES,
    REFLECTED_ARMATURE,
    SINGLE_JOINTS,
    SYMMETRIC_FORCES,
    no_shapes,
    only,
    servos,
    unread_in,
    without_attribute,
)
from mjcompose.targets.solver import BITS, COMPUTING, GRAVCOMP, SOFTNESS, unread_contacts
from mjcompose.targets.target import Target, write_mjcf

# Drake 1.51 uses the control range of a position servo, which is in radians, as the range of its torque. With
# `ctrllimited` alone, the torque is limited to zero, which it refuses.
_NO_CONTROL_RANGE = without_attribute(
    "control ranges", "actuator/position", "ctrlrange", what="`ctrlrange`",
    why="the program would take it for the range of the force", also=("ctrllimited",),
)  # fmt: skip

TARGET = Target(
    "drake",
    "Drake, by its parser of MJCF",
    (
        NO_REFERENCES, SINGLE_JOINTS, NO_EMPTY_INERTIA, NO_KEYS, NO_SENSORS, NO_CAMERAS, NO_LIGHTS, NO_SITES,
        NO_TENDONS, NO_PAIRS, NO_SOFT, NO_PLUGINS, NO_CUSTOM, NO_POLYNOMIALS, NO_SPRINGS, NO_FRICTION, NO_EFFORT,
        *unread_in("free", "damping"), no_shapes("hfield"), NO_HIDDEN_SHAPES, NO_TEXTURES,
        servos("motor", "position"), _NO_CONTROL_RANGE, AT_JOINTS, SYMMETRIC_FORCES, NO_SERVO_DAMPING, NO_DELAY,
        NO_ACTUATOR_ARMATURE, NO_ACTUATOR_DAMPING, REFLECTED_ARMATURE,
        only("equality", "equality/*", ("connect",), why="what they couple moves freely"),
        COMPUTING, GRAVCOMP, BITS, SOFTNESS, unread_contacts("torsional", "rolling"),
    ),
    write=write_mjcf,
    package="drake",
)  # fmt: skip
