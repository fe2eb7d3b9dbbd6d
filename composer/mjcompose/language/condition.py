"""Conditions of a recipe: `when` decides whether an entry belongs to a build."""

from __future__ import annotations

from collections.abc import Mapping as Map
from dataclasses import replace
from typing import Final

from mjcompose.base.sink import Sink
from mjcompose.base.suggest import unknown_name
from mjcompose.language.left_out import LeftOut
from mjcompose.language.parameters import Axes, Turn, Turned, in_unit, no_value, plain, report, same, with_unit
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import Angle, ExpressionError, Value
from mjcompose.text.merge import Path, in_own_model, is_edits
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, is_template, walk

WHEN: Final = "when"
_MAX_DEPTH = 4  # the depth of a part's edits


class Condition:
    """Decides which items belong to this build, or to `any`; `in_doubt` has names with a faulty `when`.

    In a `turn` of a `for`, a condition about its values decides in any build.
    """

    def __init__(
        self,
        scope: Map[str, Value],
        axes: Axes,
        broken: frozenset[str],
        sink: Sink,
        any: bool = False,
        turn: Turn | None = None,
    ) -> None:
        self.scope = scope
        self.axes = axes
        self.broken = broken
        self.sink = sink
        self.any = any
        self.turn = turn
        self.in_doubt: set[str] = set()
        self.left_out: list[LeftOut] = []

    def kept(self, document: Mapping) -> Mapping:
        found = self.of(document, ())
        assert isinstance(found, Mapping)
        return found

    def item(self, node: Mapping, path: Path) -> Mapping | None:
        """Return an item without its `when`, or None if it does not belong to this build."""
        if WHEN not in node.entries:
            return node
        before = self.sink.error_count
        condition = node.entries[WHEN][1]
        holds = (self.any and not self._is_of_turn(condition)) or self.holds(condition)
        if self.sink.error_count > before:
            scalars = (each.node for each in walk(node) if isinstance(each.node, Scalar))
            self.in_doubt.update([str(path[-1]), *(each.text for each in scalars)])
        if not holds:
            self.left_out.append(LeftOut(path, node, WHEN, condition, self.scope))
            return None
        return Mapping({name: each for name, each in node.entries.items() if name != WHEN}, node.span)

    def of(self, node: Node, path: Path) -> Node | None:
        """Return a node with the items that belong to this build, or None if it is an item that does not."""
        if isinstance(node, Turned):
            return node
        if isinstance(node, Mapping) and WHEN in node.entries and is_item(path):
            kept = self.item(node, path)
            if kept is None:
                return None
            node = kept
        if not has_items_below(path):
            return node
        if isinstance(node, Mapping):
            entries = node.entries.items()
            inside = ((name, key, self.of(value, (*path, name))) for name, (key, value) in entries)
            return Mapping({name: (key, value) for name, key, value in inside if value is not None}, node.span)
        if isinstance(node, Sequence):
            items = (self.of(item, (*path, index)) for index, item in enumerate(node.items))
            return Sequence(tuple(item for item in items if item is not None), node.span)
        return node

    def holds(self, node: Node) -> bool:
        if isinstance(node, Mapping):
            found = [self._is_one_of(key, value) for key, value in node.entries.values()]
            return all(found)
        if isinstance(node, Scalar):
            if isinstance(node.value, bool):
                return node.value
            if isinstance(node.value, str) and is_template(node.value):
                return self._true(node)
        message = "`when` is a mapping from variants and parameters to values, or one boolean expression"
        help = 'write `when: {gripper: hand}` or `when: "${payload > 1}"`'
        self.sink.error("wrong-type", message, node.span, help=help)
        return True

    def _is_of_turn(self, node: Node) -> bool:
        """Return whether a condition is an expression that uses a value of the turn."""
        if self.turn is None or not isinstance(node, Scalar) or not is_template(node.text):
            return False
        try:
            return any(each.name in self.turn.values for each in Template.parse(node.text).names())
        except ExpressionError:
            return False

    def _true(self, node: Scalar) -> bool:
        if self.turn is not None:
            node = replace(node, span=node.span.repeated(self.turn.text))
        try:
            value = Template.parse(str(node.value)).value(self.scope)
        except ExpressionError as error:
            report(error, node, [*self.scope], broken=self.broken, sink=self.sink)
            return True
        if not isinstance(value, bool):
            self.sink.error("wrong-type", "`when` needs `true` or `false`", node.span)
            return True
        return value

    def _is_one_of(self, key: Key, node: Node) -> bool:
        if key.name in self.broken:
            return True
        if key.name not in self.scope:
            message = f"the variant or parameter `{key.name}` does not exist"
            self.sink.add(unknown_name("name", key.name, self.scope, span=key.span, message=message))
            return True
        axis = self.axes.get(key.name)
        have = self.scope[key.name]
        holds = False
        choices = node.items if isinstance(node, Sequence) and not isinstance(have, tuple) else (node,)
        for each in choices:
            if axis is not None:
                text = each.text if isinstance(each, Scalar) else ""
                if text not in axis.entries:
                    no_value(key.name, text, axis, node=each, sink=self.sink)
                holds |= text == have
            else:
                value = plain(each)
                holds |= value is not None and same(_like(value, have), have)
        return holds


def _like(value: Value, have: Value) -> Value:
    """Return a written value in the unit of the value that a parameter has."""
    if isinstance(value, tuple) and isinstance(have, tuple) and len(value) == len(have):
        return tuple(map(_like, value, have))
    return with_unit(in_unit(value, have.unit), have.unit) if isinstance(have, Angle) else value


def has_conditions(node: Node) -> bool:
    mappings = ((path, each) for path, _, each in walk(node) if isinstance(each, Mapping))
    return any(WHEN in each.entries and is_item(path) for path, each in mappings)


def has_items_below(path: Path) -> bool:
    """Return whether there may be entries below this path that can have `when` and `for`."""
    return len(in_own_model(path)) < _MAX_DEPTH


def is_item(path: Path) -> bool:
    """Return whether there is an entry at this path that can have `when` and `for`."""
    own = in_own_model(path)
    from mjcompose.language.recipe import DEPTHS  # the forms of the language, which few commands need before this

    return is_edits(own[:-1]) or (len(own) > 0 and len(own) == DEPTHS.get(str(own[0])))
