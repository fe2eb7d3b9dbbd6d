"""Target: Isaac Sim, by its importer of MJCF."""

from __future__ import annotations

from mjcompose.targets.restrictions import NO_CUSTOM, NO_KEYS, NO_PLUGINS, NO_SOFT
from mjcompose.targets.target import Target, write_mjcf

TARGET = Target(
    "isaac", "Isaac Sim, by its importer of MJCF", (NO_KEYS, NO_SOFT, NO_PLUGINS, NO_CUSTOM), write=write_mjcf
)
