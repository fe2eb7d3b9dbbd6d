"""Target: the plainest MJCF, for programs that have no target of their own."""

from __future__ import annotations

from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "plain", "MJCF without frames, classes, replicates and flexcomps, with inertias and OBJ meshes", (),
    write=write_mjcf, package="mujoco",
)  # fmt: skip
