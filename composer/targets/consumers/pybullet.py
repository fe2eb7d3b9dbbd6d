"""Target: PyBullet. It reads bodies, joints and geoms, and places a body in the world by its centre of mass."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.actuators import servos
from composer.targets.restrictions.solver import COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from composer.targets.restrictions.tree import NO_REFERENCES, SINGLE_JOINTS, one_root
from composer.targets.restrictions.unread import (
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
    NO_SENSORS,
    NO_SITES,
    NO_SOFT,
    NO_SPRINGS,
    NO_TENDONS,
    no_shapes,
    refused,
)
from composer.targets.target import Target

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
