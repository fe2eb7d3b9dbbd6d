"""Verb `collision`. Few recipes need it, so the module that does the work is imported here only when it runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mjcompose.base.diagnostic import Path
from mjcompose.build.verbs.values import Entry


def carry_out(entry: Entry, value: Mapping[str, Any], at: Path) -> None:
    """Replace how the selected geoms touch. All values that the entry writes are checked before."""
    from mjcompose.build.compose.shapes import make_collision_geoms

    entry.check()
    entry.records += make_collision_geoms(entry.editing, entry.workshop, entry.found, value=value, at=at)
