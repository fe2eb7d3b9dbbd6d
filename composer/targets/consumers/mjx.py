"""Target: MJX, MuJoCo in JAX. It refuses to load a model with a feature that it does not support."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.actuators import NO_ACTUATOR_ARMATURE, NO_ACTUATOR_DAMPING, NO_DELAY
from composer.targets.restrictions.collisions import MJX_COLLISIONS
from composer.targets.restrictions.mjx import (
    MJX_ACTUATORS,
    MJX_CONTACT_SENSORS,
    MJX_EQUALITY,
    MJX_MARGINS,
    MJX_OPTIONS,
    MJX_PAIR_MARGINS,
    MJX_SENSORS,
    MJX_SOFT,
)
from composer.targets.restrictions.unread import NO_PLUGINS, NO_POLYNOMIALS, NO_YIELD
from composer.targets.target import Target

TARGET = Target(
    "mjx",
    "MJX, MuJoCo in JAX",
    (
        MJX_SOFT, NO_PLUGINS, NO_POLYNOMIALS, NO_YIELD, NO_ACTUATOR_ARMATURE, NO_ACTUATOR_DAMPING, NO_DELAY,
        MJX_COLLISIONS, MJX_MARGINS, MJX_PAIR_MARGINS, MJX_ACTUATORS, MJX_EQUALITY, MJX_SENSORS, MJX_CONTACT_SENSORS,
        MJX_OPTIONS,
    ),
    write=write_mjcf,
    package="mujoco-mjx",
)  # fmt: skip
