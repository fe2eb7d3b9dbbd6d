"""Target: Isaac Sim, by its importer of MJCF."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.unread import NO_CUSTOM, NO_KEYS, NO_PLUGINS, NO_SOFT
from composer.targets.target import Target

TARGET = Target(
    "isaac", "Isaac Sim, by its importer of MJCF", (NO_KEYS, NO_SOFT, NO_PLUGINS, NO_CUSTOM), write=write_mjcf
)
