"""The pieces of recipe that a build does not take: what is wrong in them is told all the same."""

from __future__ import annotations

from collections.abc import Mapping as Map

from composer.diagnostics.sink import Sink
from composer.document.node import Mapping, Node, spans
from composer.expand.expand import expand
from composer.expand.plain import node_of
from composer.expand.variants import choose, read_axes
from composer.recipe.validate import validate_what_remains

# What may be right in a build that chooses another piece as well.
_MAY_BE_ELSEWHERE = ("missing-key", "expression", "unknown-name")


def check_pieces(document: Mapping, given: Map[str, Node], sink: Sink) -> None:
    """Judge every piece of `variants` that is not chosen, each over the recipe, and tell the faults that lie in it."""
    axes = read_axes(document, Sink())
    chosen = choose(axes, given, Sink())
    for axis, values in axes.items():
        for value, (key, piece) in values.entries.items():
            if value == chosen[axis]:
                continue
            aside, places = Sink(), set(spans(piece))
            concrete = expand(document, {**given, axis: node_of(value, key.span)}, aside)
            validate_what_remains(concrete.document, aside)
            for fault in aside.errors:
                if fault.code not in _MAY_BE_ELSEWHERE and fault.span in places:
                    sink.add(fault)
