"""Verb `simplify`: give meshes fewer faces."""

from __future__ import annotations

from mjcompose.base.diagnostic import Path
from mjcompose.compose.shapes import simplify_meshes
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.verbs.simplify import Simplify


def carry_out(verb: Simplify, entry: Entry, at: Path) -> None:
    # All values that the entry writes are checked before.
    entry.check()
    entry.records += simplify_meshes(entry.editing, entry.workshop, entry.found, faces=verb.faces, at=at)
