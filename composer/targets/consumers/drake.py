"""Target: Drake. Its parser of MJCF reads bodies, joints, geoms, motors, position servos and `connect`."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.attributes import without_attribute
from composer.targets.restrictions.left_out import only
from composer.targets.restrictions.massless import NO_EMPTY_INERTIA
from composer.targets.restrictions.references import NO_REFERENCES
from composer.targets.restrictions.servos import servos
from composer.targets.restrictions.single_joints import SINGLE_JOINTS
from composer.targets.restrictions.solver import BITS, COMPUTING, GRAVCOMP, SOFTNESS, unread_contacts
from composer.targets.restrictions.unread import (
    NO_CAMERAS,
    NO_CUSTOM,
    NO_FRICTION,
    NO_KEYS,
    NO_LIGHTS,
    NO_PAIRS,
    NO_PLUGINS,
    NO_SENSORS,
    NO_SITES,
    NO_SOFT,
    NO_SPRINGS,
    NO_TENDONS,
)
from composer.targets.target import Target

# Drake 1.51 uses the control range of a position servo, which is in radians, as the range of its torque.
_NO_CONTROL_RANGE = without_attribute(
    "control ranges",
    "actuator/position",
    "ctrlrange",
    "the range of its control would be read as that of its force",
)

TARGET = Target(
    "drake",
    "Drake, by its parser of MJCF",
    (
        NO_REFERENCES, SINGLE_JOINTS, NO_EMPTY_INERTIA, NO_KEYS, NO_SENSORS, NO_CAMERAS, NO_LIGHTS, NO_SITES,
        NO_TENDONS,
        NO_PAIRS, NO_SOFT, NO_PLUGINS, NO_CUSTOM, NO_SPRINGS, NO_FRICTION, servos("motor", "position"),
        _NO_CONTROL_RANGE,
        only("equality", "equality/*", ("connect",), "of equality constraints only `connect` is read: what it couples"
             " moves freely"),
        COMPUTING, GRAVCOMP, BITS, SOFTNESS, unread_contacts("torsional", "rolling"),
    ),
    write_mjcf,
    "drake",
)  # fmt: skip
