"""The pieces of a recipe for other builds: report their faults, and find out whether the recipe has other models."""

from __future__ import annotations

from collections.abc import Iterator, Set
from collections.abc import Mapping as Map

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node, Scalar, Sequence, spans
from composer.expand.expand import expand
from composer.expand.plain import node_of
from composer.expand.variants import choose, read_axes
from composer.expand.when import has_conditions
from composer.expr.opening import is_template
from composer.recipe.validate import validate_what_remains

# These may be correct in a build that also chooses another piece.
_MAY_BE_ELSEWHERE = ("missing-key", "expression", "unknown-name")


def check_pieces(document: Mapping, given: Map[str, Node], sink: Sink) -> None:
    """Validate the pieces of a recipe that a build leaves out, and report their faults.

    These are the items that `when` limits to other builds, and each piece of `variants` that is not chosen, merged
    over the recipe.
    """
    if has_conditions(document):
        _judge(document, given, None, sink=sink)
    axes = read_axes(document, Sink())
    chosen = choose(axes, given, Sink())
    for axis, values in axes.items():
        for value, (key, piece) in values.entries.items():
            if value != chosen.get(axis):
                _judge(document, {**given, axis: node_of(value, key.span)}, set(spans(piece)), sink=sink)


def _judge(document: Mapping, given: Map[str, Node], places: Set[Span] | None, sink: Sink) -> None:
    """Report the faults, in these places, of a build with the items of all builds."""
    aside, computed = Sink(), set(_computed(document))
    validate_what_remains(expand(document, given, aside, any=True).document, aside)
    for fault in aside.errors:
        is_reported = places is None or fault.span in places
        if is_reported and fault.code not in _MAY_BE_ELSEWHERE and fault.span not in computed:
            sink.add(fault)


def _computed(node: Node) -> Iterator[Span]:
    """Yield the places of computed values, which differ in their own build, and of lists of such values."""
    if isinstance(node, Scalar):
        if isinstance(node.value, str) and is_template(node.value):
            yield node.span
        return
    items = node.items if isinstance(node, Sequence) else [value for _, value in node.entries.values()]
    if isinstance(node, Sequence) and any(
        isinstance(item, Scalar) and is_template(item.text) for item in items
    ):
        yield node.span
    for item in items:
        yield from _computed(item)


_OF_MODELS = ("base", "model", "with")
_OF_PIECES = ("variants", "matrix")


def parameters_choose(recipe: Node | None) -> bool:
    """Return whether a parameter can change the models: by `when`, or by an expression in a reference. No I/O."""
    waiting = [(recipe, False)]
    while waiting:
        node, naming = waiting.pop()
        if isinstance(node, Scalar):
            if naming and "${" in node.text:
                return True
        elif isinstance(node, Sequence):
            waiting += [(each, naming) for each in node.items]
        elif isinstance(node, Mapping):
            if "when" in node.entries:
                return True
            waiting += [(value, naming or name in _OF_MODELS) for name, (_, value) in node.entries.items()]
    return False


def is_one_choice(recipe: Node | None) -> bool:
    """Return whether a recipe has the same models in all its builds. No I/O."""
    pieces = isinstance(recipe, Mapping) and any(name in recipe.entries for name in _OF_PIECES)
    return not pieces and not parameters_choose(recipe)
