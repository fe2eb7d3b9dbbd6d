"""The section `variants`: named pieces of recipe, of which one for each axis is merged over the recipe."""

from __future__ import annotations

from collections.abc import Mapping as Map

from composer.diagnostics.sink import Sink
from composer.diagnostics.unknown import unknown_name
from composer.document.merge import merge
from composer.document.node import Mapping, Node, Scalar, Sequence
from composer.expand.name import is_usable

# Keys that belong to the recipe as a whole, and not to a piece of it.
NO_PIECE = ("recipe", "extends", "trust", "variants", "matrix", "separator", "angle", "eulerseq")

Axes = dict[str, Mapping]


def read_axes(document: Mapping, sink: Sink) -> Axes:
    """Return each axis with its pieces by value, without faulty ones."""
    found = document.entries.get("variants")
    if found is None:
        return {}
    help = "write `variants: {gripper: {small: {…}, large: {…}}}`"
    if not isinstance(found[1], Mapping):
        if words := _words(found[1]):
            help = f"write `variants: {{AXIS: {_pieces(words)}}}`"
        sink.error(
            "wrong-type", "`variants` is a mapping from axes to their values", found[1].span, help=help
        )
        return {}
    axes: Axes = {}
    for key, values in found[1].entries.values():
        if not is_usable(key, "a variant", sink):
            continue
        if not isinstance(values, Mapping) or not values.entries:
            message = f"variant `{key.name}` is a mapping from its values to pieces of recipe"
            words = _words(values)
            own = f"write `{key.name}: {_pieces(words)}`, each with what it changes" if words else help
            sink.error("wrong-type", message, key.span, help=own)
            continue
        axes[key.name] = values
        for value, piece in values.entries.values():
            if not isinstance(piece, Mapping):
                message = f"`{value.name}` of variant `{key.name}` is a piece of recipe, a mapping"
                sink.error(
                    "wrong-type",
                    message,
                    value.span,
                    help=f"write `{value.name}: {{}}` for one that changes nothing",
                )
                continue
            if piece.entries.keys().isdisjoint(NO_PIECE):
                continue
            for name in NO_PIECE:
                if name in piece.entries:
                    sink.error("unknown-key", f"`{name}` cannot stand in a variant", piece.entries[name][0].span,
                               help="write it at the top of the recipe")  # fmt: skip
    return axes


def _words(node: Node) -> list[str]:
    """Return the texts of a list of texts, or a single text."""
    items = node.items if isinstance(node, Sequence) else (node,)
    texts = [item.text for item in items if isinstance(item, Scalar) and item.text]
    return texts if len(texts) == len(items) else []


def _pieces(values: list[str]) -> str:
    return f"{{{', '.join(f'{value}: {{}}' for value in values)}}}"


def choose(axes: Axes, given: Map[str, Node], sink: Sink) -> dict[str, str]:
    """Return the value of every axis: the given one, else the first."""
    chosen: dict[str, str] = {}
    for axis, values in axes.items():
        node = given.get(axis)
        if node is None:
            chosen[axis] = next(iter(values.entries))
            continue
        value = node.text if isinstance(node, Scalar) else ""
        if value in values.entries:
            chosen[axis] = value
            continue
        no_value(axis, value, values, node=node, sink=sink)
    return chosen


def no_value(axis: str, value: str, values: Mapping, node: Node, sink: Sink) -> None:
    """Report that an axis does not have a value."""
    message = f"variant `{axis}` has no value `{value}`"
    sink.add(unknown_name("value", value, values.entries, span=node.span, message=message))


def merged(document: Mapping, axes: Axes, chosen: Map[str, str], sink: Sink) -> Mapping:
    """Merge the chosen pieces over the recipe, in the order of their axes."""
    for axis, value in chosen.items():
        piece = axes[axis].entries[value][1]
        if isinstance(piece, Mapping):
            document = merge(document, _permitted(piece), sink)
    return document


def _permitted(piece: Mapping) -> Mapping:
    return Mapping({name: entry for name, entry in piece.entries.items() if name not in NO_PIECE}, piece.span)
