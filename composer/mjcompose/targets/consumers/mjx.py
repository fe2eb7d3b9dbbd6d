"""Target: MJX, MuJoCo in JAX. It refuses to load a model with a feature that it does not support."""

from __future__ import annotations

from mjcompose.targets import restrictions as limits
from mjcompose.targets import simulators
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "mjx", "MJX, MuJoCo in JAX", (
        simulators.MJX_SOFT, limits.NO_PLUGINS, limits.NO_POLYNOMIALS, limits.NO_YIELD, limits.NO_ACTUATOR_ARMATURE,
        limits.NO_ACTUATOR_DAMPING, limits.NO_DELAY, simulators.MJX_COLLISIONS, simulators.MJX_MARGINS,
        simulators.MJX_PAIR_MARGINS, simulators.MJX_ACTUATORS, simulators.MJX_EQUALITY, simulators.MJX_SENSORS,
        simulators.MJX_CONTACT_SENSORS, simulators.MJX_OPTIONS,
    ), write=write_mjcf, package="mujoco-mjx",
)  # fmt: skip
