"""Verb `collision`: replace meshes in collisions by convex shapes made from them."""

from __future__ import annotations

from mjcompose.base.diagnostic import Path
from mjcompose.compose.shapes import make_collision_geoms
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.verbs.collision import Collision


def carry_out(verb: Collision, entry: Entry, at: Path) -> None:
    # All values that the entry writes are checked before.
    entry.check()
    entry.records += make_collision_geoms(entry.editing, entry.workshop, entry.found, how=verb, at=at)
