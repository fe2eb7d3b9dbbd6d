"""Target: MuJoCo Warp, MuJoCo on NVIDIA GPUs. It refuses to load a model with a feature that it does not support."""

from __future__ import annotations

from mjcompose.targets import simulators
from mjcompose.targets.restrictions import NO_YIELD
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "warp", "MuJoCo Warp, MuJoCo on GPUs of NVIDIA", (
        NO_YIELD, simulators.WARP_ACTUATORS, simulators.WARP_EQUALITY, simulators.WARP_SENSORS, simulators.WARP_OPTIONS,
        simulators.WARP_PLUGINS, simulators.WARP_FLEXES, simulators.WARP_BESIDE_FLEXES, simulators.WARP_VELOCITIES,
        simulators.WARP_ACTUATOR_PLUGINS, simulators.WARP_SLEEP,
    ), write=write_mjcf, package="mujoco-warp",
)  # fmt: skip
