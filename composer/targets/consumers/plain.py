"""Target: the plainest MJCF, for programs that have no target of their own."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.target import Target

TARGET = Target(
    "plain",
    "MJCF without frames, classes, replicates and flexcomps, with inertias and OBJ meshes",
    (),
    write=write_mjcf,
    package="mujoco",
)
