"""Target: Pinocchio. It reads one body in the world, and one joint in each body."""

from __future__ import annotations

from mjcompose.targets import restrictions as limits
from mjcompose.targets.solver import BITS, COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "pinocchio", "Pinocchio, by its parser of MJCF", (
        limits.one_root(with_free=True), limits.NO_REFERENCES, limits.SINGLE_JOINTS, limits.NO_KEYS, limits.NO_SENSORS,
        limits.NO_CAMERAS, limits.NO_LIGHTS, limits.NO_TENDONS, limits.NO_EQUALITY, limits.NO_PAIRS, limits.NO_EXCLUDES,
        limits.NO_SOFT, limits.NO_PLUGINS, limits.NO_CUSTOM, limits.NO_POLYNOMIALS, limits.NO_SPRINGS,
        *limits.unread_in("free", "damping", "frictionloss"), *limits.unread_in("ball", "damping", "frictionloss"),
        limits.no_shapes("hfield"), limits.CARRIED_FORCES, limits.servos(), COMPUTING, GRAVITY, GRAVCOMP, BITS,
        SOFTNESS, unread_contacts("sliding", "torsional", "rolling"),
    ), write=write_mjcf, package="pin",
)  # fmt: skip
