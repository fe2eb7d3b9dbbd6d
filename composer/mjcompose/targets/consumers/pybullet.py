"""Target: PyBullet. It reads bodies, joints and geoms, and places a body in the world by its center of mass."""

from __future__ import annotations

from mjcompose.targets import restrictions as limits
from mjcompose.targets.solver import COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "pybullet", "PyBullet, by its parser of MJCF", (
        limits.refused("ball", ".//joint[@type='ball']", "PyBullet has no ball joints in MJCF",
                       help="convert it to three hinges"),
        limits.one_root(with_free=False), limits.NO_REFERENCES, limits.SINGLE_JOINTS, limits.NO_KEYS, limits.NO_SENSORS,
        limits.NO_CAMERAS, limits.NO_LIGHTS, limits.NO_SITES, limits.NO_TENDONS, limits.NO_EQUALITY, limits.NO_PAIRS,
        limits.NO_EXCLUDES, limits.NO_SOFT, limits.NO_PLUGINS, limits.NO_CUSTOM, limits.NO_DAMPING, limits.NO_FRICTION,
        limits.NO_ARMATURE, limits.NO_EFFORT, limits.NO_SPRINGS, limits.no_shapes("ellipsoid", "hfield"),
        limits.servos(), COMPUTING, GRAVITY, GRAVCOMP, SOFTNESS, unread_contacts(but=("condim",)),
    ), write=write_mjcf, package="pybullet",
)  # fmt: skip
