"""Target: MJX, MuJoCo in JAX. It refuses to load a model with a feature that it does not support."""

from __future__ import annotations

from mjcompose.targets.restrictions import (
    NO_ACTUATOR_ARMATURE,
    NO_ACTUATOR_DAMPING,
    NO_DELAY,
    NO_PLUGINS,
    NO_POLYNOMIALS,
    NO_YIELD,
)
from mjcompose.targets.simulators import (
    MJX_ACTUATORS,
    MJX_COLLISIONS,
    MJX_CONTACT_SENSORS,
    MJX_EQUALITY,
    MJX_MARGINS,
    MJX_OPTIONS,
    MJX_PAIR_MARGINS,
    MJX_SENSORS,
    MJX_SOFT,
)
from mjcompose.targets.target import Target, write_mjcf

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
