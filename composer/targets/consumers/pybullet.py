"""Target: PyBullet. It reads bodies, joints and geoms, and places a body in the world by its centre of mass."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.references import NO_REFERENCES
from composer.targets.restrictions.roots import one_root
from composer.targets.restrictions.servos import servos
from composer.targets.restrictions.single_joints import SINGLE_JOINTS
from composer.targets.restrictions.solver import COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from composer.targets.restrictions.unread import (
    NO_CAMERAS,
    NO_CUSTOM,
    NO_EQUALITY,
    NO_EXCLUDES,
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

TARGET = Target(
    "pybullet",
    "PyBullet, by its parser of MJCF",
    (
        one_root(with_free=False), NO_REFERENCES, SINGLE_JOINTS, NO_KEYS, NO_SENSORS, NO_CAMERAS, NO_LIGHTS, NO_SITES,
        NO_TENDONS, NO_EQUALITY, NO_PAIRS, NO_EXCLUDES, NO_SOFT, NO_PLUGINS, NO_CUSTOM, NO_SPRINGS, servos(),
        COMPUTING, GRAVITY, GRAVCOMP, SOFTNESS, unread_contacts(but=("condim",)),
    ),
    write_mjcf,
    "pybullet",
)  # fmt: skip
