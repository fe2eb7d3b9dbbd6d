"""Target: MuJoCo Warp, MuJoCo on NVIDIA GPUs. It refuses to load a model with a feature that it does not support."""

from __future__ import annotations

from mjcompose.targets.restrictions import NO_YIELD
from mjcompose.targets.simulators import (
    WARP_ACTUATOR_PLUGINS,
    WARP_ACTUATORS,
    WARP_BESIDE_FLEXES,
    WARP_EQUALITY,
    WARP_FLEXES,
    WARP_OPTIONS,
    WARP_PLUGINS,
    WARP_SENSORS,
    WARP_SLEEP,
    WARP_VELOCITIES,
)
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "warp",
    "MuJoCo Warp, MuJoCo on GPUs of NVIDIA",
    (
        NO_YIELD, WARP_ACTUATORS, WARP_EQUALITY, WARP_SENSORS, WARP_OPTIONS, WARP_PLUGINS, WARP_FLEXES,
        WARP_BESIDE_FLEXES, WARP_VELOCITIES, WARP_ACTUATOR_PLUGINS, WARP_SLEEP,
    ),
    write=write_mjcf,
    package="mujoco-warp",
)  # fmt: skip
