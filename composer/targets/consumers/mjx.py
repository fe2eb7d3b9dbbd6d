"""Target: MJX, MuJoCo in JAX. What it lacks stops it when it loads a model."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.collisions import MJX_COLLISIONS
from composer.targets.restrictions.left_out import only, refused
from composer.targets.restrictions.unread import NO_PLUGINS, NO_SOFT
from composer.targets.target import Target

_ACTUATORS = (
    "motor", "position", "velocity", "general", "muscle", "intvelocity", "damper", "cylinder", "adhesion",
)  # fmt: skip

TARGET = Target(
    "mjx",
    "MJX, MuJoCo in JAX",
    (
        MJX_COLLISIONS,
        NO_SOFT,
        NO_PLUGINS,
        only("actuators", "actuator/*", _ACTUATORS, "MJX has no such actuator"),
        refused(
            "contact sensors",
            "sensor/contact[@site]",
            "MJX has no contact sensor of a site",
            "name geoms in its place",
        ),
    ),
    write_mjcf,
    "mujoco-mjx",
)
