"""Target: Newton. It merges several joints of a body into one, and does not read flexes."""

from __future__ import annotations

from mjcompose.targets.restrictions import (
    CARRIED_FORCES,
    GEARS,
    NO_PLUGINS,
    NO_POLYNOMIALS,
    NO_REFERENCES,
    NO_SOFT,
    NO_YIELD,
    single_joints,
    unread_in,
)
from mjcompose.targets.solver import GRAVITY
from mjcompose.targets.target import Target, write_mjcf

_MASS = "1e-10"
"""What moves needs a mass in the solver of Newton that is MuJoCo."""

TARGET = Target(
    "newton",
    "Newton, by its parser of MJCF",
    (
        NO_REFERENCES,
        single_joints(_MASS),
        NO_SOFT,
        NO_PLUGINS,
        NO_POLYNOMIALS,
        NO_YIELD,
        *unread_in("free", "damping", "armature", "frictionloss"),
        CARRIED_FORCES,
        GEARS,
        GRAVITY,
    ),
    write=write_mjcf,
    package="newton",
)
