"""Target: Newton. It merges several joints of a body into one, and does not read flexes."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.actuators import CARRIED_FORCES, GEARS
from composer.targets.restrictions.solver import GRAVITY
from composer.targets.restrictions.tree import NO_REFERENCES, single_joints
from composer.targets.restrictions.unread import NO_PLUGINS, NO_POLYNOMIALS, NO_SOFT, NO_YIELD, unread_in
from composer.targets.target import Target

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
