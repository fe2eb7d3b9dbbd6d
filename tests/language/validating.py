"""A recipe without faults, from a located tree."""

from __future__ import annotations

from mjcompose.base.sink import Sink
from mjcompose.language.recipe import Recipe
from mjcompose.language.validate import validate_what_remains
from mjcompose.text.node import Node


def validate(node: Node, sink: Sink) -> Recipe | None:
    """Return the recipe, or None after reported errors."""
    before = sink.error_count
    found = validate_what_remains(node, sink)
    return found.recipe if found is not None and sink.error_count == before else None
