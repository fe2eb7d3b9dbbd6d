"""Target: Newton. It merges several joints of a body into one, and does not read flexes."""

from __future__ import annotations

from mjcompose.targets import restrictions as limits
from mjcompose.targets.solver import GRAVITY
from mjcompose.targets.target import Target, write_mjcf

_MASS = "1e-10"
"""Moving bodies need a mass in the solver of Newton that is MuJoCo."""

TARGET = Target(
    "newton", "Newton, by its parser of MJCF", (
        limits.NO_REFERENCES, limits.single_joints(_MASS), limits.NO_SOFT, limits.NO_PLUGINS, limits.NO_POLYNOMIALS,
        limits.NO_YIELD, *limits.unread_in("free", "damping", "armature", "frictionloss"), limits.CARRIED_FORCES,
        limits.GEARS, GRAVITY,
    ), write=write_mjcf, package="newton",
)  # fmt: skip
