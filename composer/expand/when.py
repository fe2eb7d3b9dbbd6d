"""`when`: conditions for items that belong to some builds only."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Mapping as Map

from composer.diagnostics.sink import Sink
from composer.diagnostics.unknown import unknown_name
from composer.document.node import Key, Mapping, Node, Scalar, Sequence
from composer.document.piece import Path, in_own_model, is_edits
from composer.expand.plain import plain, same
from composer.expand.substitute import report
from composer.expand.variants import Axes, no_value
from composer.expr.error import ExpressionError
from composer.expr.opening import is_template
from composer.expr.value import Value

WHEN = "when"
# The depth of items that may have a condition: `sensor.NAME`, `asset.mesh.NAME`, `add[0]`.
_DEPTH = {
    **dict.fromkeys(("attach", "add", "edit", "check", "keyframe"), 2),
    **dict.fromkeys(("sensor", "actuator", "equality", "tendon", "default"), 2),
    **dict.fromkeys(("asset", "contact", "custom", "deformable", "extension"), 3),
    **dict.fromkeys(("option", "size", "visual", "statistic", "compiler"), 1),
}  # fmt: skip
_MAX_DEPTH = 4  # the depth of a part's edits


class Condition:
    """Decides by the values of variants and parameters which items belong to this build.

    For `any` build it keeps all items. `in_doubt` has the names and values of items that are kept because their
    `when` is faulty.
    """

    def __init__(
        self, scope: Map[str, Value], axes: Axes, broken: frozenset[str], sink: Sink, any: bool = False
    ) -> None:
        self.scope, self.axes, self.broken, self.sink, self.any = scope, axes, broken, sink, any
        self.in_doubt: set[str] = set()

    def kept(self, document: Mapping) -> Mapping:
        """Return the recipe of this build, without any `when`."""
        found = self._kept(document, ())
        assert isinstance(found, Mapping)
        return found

    def _kept(self, node: Node, path: Path) -> Node | None:
        if _is_item(path) and isinstance(node, Mapping) and WHEN in node.entries:
            before = self.sink.error_count
            holds = self.any or self.holds(node.entries[WHEN][1])
            if self.sink.error_count > before:
                self.in_doubt.update([str(path[-1]), *_values(node)])
            if not holds:
                return None
            node = Mapping({name: each for name, each in node.entries.items() if name != WHEN}, node.span)
        if len(in_own_model(path)) >= _MAX_DEPTH:
            return node
        if isinstance(node, Mapping):
            entries = {
                name: (key, self._kept(value, (*path, name))) for name, (key, value) in node.entries.items()
            }
            return Mapping(dict(_present(entries)), node.span)
        if isinstance(node, Sequence):
            items = [self._kept(item, (*path, index)) for index, item in enumerate(node.items)]
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
        self.sink.error(
            "wrong-type",
            "`when` is a mapping from variants and parameters to values, or one boolean expression",
            node.span,
            help='write `when: {gripper: hand}` or `when: "${payload > 1}"`',
        )
        return True

    def _true(self, node: Scalar) -> bool:
        from composer.expr.template import Template  # most recipes have no expression

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
        for each in node.items if isinstance(node, Sequence) and not isinstance(have, tuple) else (node,):
            if axis is not None:
                text = each.text if isinstance(each, Scalar) else ""
                if text not in axis.entries:
                    no_value(key.name, text, axis, node=each, sink=self.sink)
                holds |= text == have
            else:
                value = plain(each)
                holds |= value is not None and same(value, have)
        return holds


def _values(node: Node) -> Iterator[str]:
    if isinstance(node, Scalar):
        yield node.text
    else:
        inner = node.items if isinstance(node, Sequence) else [value for _, value in node.entries.values()]
        for each in inner:
            yield from _values(each)


def has_conditions(node: Node, path: Path = ()) -> bool:
    """Return whether some item of a recipe belongs to some builds only."""
    if isinstance(node, Mapping):
        if WHEN in node.entries and _is_item(path):
            return True
        inner = [((*path, name), value) for name, (_, value) in node.entries.items()]
    else:
        items = node.items if isinstance(node, Sequence) else ()
        inner = [((*path, index), item) for index, item in enumerate(items)]
    return len(in_own_model(path)) < _MAX_DEPTH and any(
        has_conditions(value, below) for below, value in inner
    )


def _is_item(path: Path) -> bool:
    """Return whether the item at this path may have a condition."""
    own = in_own_model(path)
    return is_edits(own[:-1]) or (len(own) > 0 and len(own) == _DEPTH.get(str(own[0])))


def _present(entries: Map[str, tuple[Key, Node | None]]) -> Iterator[tuple[str, tuple[Key, Node]]]:
    for name, (key, value) in entries.items():
        if value is not None:
            yield name, (key, value)
