"""Target: Genesis. It reads MJCF with MuJoCo."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.unread import NO_PLUGINS, NO_SOFT
from composer.targets.target import Target

TARGET = Target(
    "genesis",
    "Genesis, which reads MJCF with MuJoCo",
    (NO_SOFT, NO_PLUGINS),
    write_mjcf,
    "genesis-world",
)
