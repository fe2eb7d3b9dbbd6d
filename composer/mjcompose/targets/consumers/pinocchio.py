"""Target: Pinocchio. It reads one body in the world, and one joint in each body."""

from __future__ import annotations

from mjcompose.targets.restrictions import (
    CARRIED_FORCES,
    NO_CAMERAS,
    NO_CUSTOM,
    NO_EQUALITY,
    NO_EXCLUDES,
    NO_KEYS,
    NO_LIGHTS,
    NO_PAIRS,
    NO_PLUGINS,
    NO_POLYNOMIALS,
    NO_REFERENCES,
    NO_SENSORS,
    NO_SOFT,
    NO_SPRINGS,
    NO_TENDONS,
    SINGLE_JOINTS,
    no_shapes,
    one_root,
    servos,
    unread_in,
)
from mjcompose.targets.solver import BITS, COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "pinocchio",
    "Pinocchio, by its parser of MJCF",
    (
        one_root(with_free=True), NO_REFERENCES, SINGLE_JOINTS, NO_KEYS, NO_SENSORS, NO_CAMERAS, NO_LIGHTS, NO_TENDONS,
        NO_EQUALITY, NO_PAIRS, NO_EXCLUDES, NO_SOFT, NO_PLUGINS, NO_CUSTOM, NO_POLYNOMIALS, NO_SPRINGS,
        *unread_in("free", "damping", "frictionloss"), *unread_in("ball", "damping", "frictionloss"),
        no_shapes("hfield"), CARRIED_FORCES, servos(),
        COMPUTING, GRAVITY, GRAVCOMP, BITS, SOFTNESS, unread_contacts("sliding", "torsional", "rolling"),
    ),
    write=write_mjcf,
    package="pin",
)  # fmt: skip
