"""Target: PyBullet. It reads bodies, joints and geoms, and places a body in the world by its centre of mass."""

from __future__ import annotations

from mjcompose.targets.restrictions import (
    NO_ARMATURE,
    NO_CAMERAS,
    NO_CUSTOM,
    NO_DAMPING,
    NO_EFFORT,
    NO_EQUALITY,
    NO_EXCLUDES,
    NO_FRICTION,
    NO_KEYS,
    NO_LIGHTS,
    NO_PAIRS,
    NO_PLUGINS,
    NO_REFERENCES,
    NO_SENSORS,
    NO_SITES,
    NO_SOFT,
    NO_SPRINGS,
    NO_TENDONS,
    SINGLE_JOINTS,
    no_shapes,
    one_root,
    refused,
    servos,
)
from mjcompose.targets.solver import COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "pybullet",
    "PyBullet, by its parser of MJCF",
    (
        refused("ball", ".//joint[@type='ball']", "PyBullet has no ball joints in MJCF", "convert it to three hinges"),
        one_root(with_free=False), NO_REFERENCES, SINGLE_JOINTS, NO_KEYS, NO_SENSORS, NO_CAMERAS, NO_LIGHTS, NO_SITES,
        NO_TENDONS, NO_EQUALITY, NO_PAIRS, NO_EXCLUDES, NO_SOFT, NO_PLUGINS, NO_CUSTOM, NO_DAMPING, NO_FRICTION,
        NO_ARMATURE, NO_EFFORT, NO_SPRINGS, no_shapes("ellipsoid", "hfield"), servos(),
        COMPUTING, GRAVITY, GRAVCOMP, SOFTNESS, unread_contacts(but=("condim",)),
    ),
    write_mjcf,
    "pybullet",
)  # fmt: skip
