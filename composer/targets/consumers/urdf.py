"""Target: a ROS package with URDF, `ros2_control` and SRDF."""

from __future__ import annotations

from composer.targets.restrictions.left_out import refused
from composer.targets.restrictions.solver import BITS, COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from composer.targets.restrictions.unread import (
    NO_CAMERAS,
    NO_CUSTOM,
    NO_LIGHTS,
    NO_PAIRS,
    NO_PLUGINS,
    NO_SENSORS,
    NO_SOFT,
    NO_SPRINGS,
    NO_TENDONS,
)
from composer.targets.target import Target
from composer.targets.urdf.limits import ARMATURE, CONTROL, FLOATING, MIMICS, SHAPES
from composer.targets.urdf.write import write_urdf

TARGET = Target(
    "urdf",
    "a ROS package: URDF with `ros2_control`, SRDF, meshes under `package://`",
    (
        refused("ball", ".//joint[@type='ball']", "URDF has no ball joints", "convert it to three hinges"),
        FLOATING, SHAPES, ARMATURE, MIMICS, CONTROL, NO_SENSORS, NO_CAMERAS, NO_LIGHTS, NO_TENDONS, NO_PAIRS,
        NO_SOFT, NO_PLUGINS, NO_CUSTOM, NO_SPRINGS,
        COMPUTING, GRAVITY, GRAVCOMP, BITS, SOFTNESS, unread_contacts("sliding", "torsional", "rolling"),
    ),
    write_urdf,
    "pin",
)  # fmt: skip
