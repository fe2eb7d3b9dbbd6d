"""New values for the attributes of an element: what `set`, `scale` and `offset` share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lxml.etree import _Element as Node

from composer.compose.edit_values import Values
from composer.compose.editing import Editing
from composer.compose.mass import Masses
from composer.compose.refuse import refuse
from composer.compose.verbs.arithmetic import compute
from composer.compose.verbs.entry import Entry
from composer.compose.verbs.operation import SET, Operation
from composer.compose.verbs.whole_value import check_units, set_whole
from composer.dataclass import dataclass
from composer.recipe.fault import Fault, Path
from composer.recipe.select import unknown_attribute
from composer.recipe.subscript import attribute_and_index
from composer.recipe.verbs.values import MASS
from composer.tree.kinds import kind_of


def change_all(entry: Entry, operation: Operation, written: Mapping[str, Any], at: Path) -> None:
    """Give the attributes of every selected element new values."""
    change = Change(entry.editing, operation, entry.masses)
    for index, node in enumerate(entry.found):
        change.carry_out(node, index, written, at=at)


@dataclass(frozen=True, slots=True)
class Change:
    """Gives the attributes of elements new values, by one operation."""

    editing: Editing
    operation: Operation
    masses: Masses

    def carry_out(self, node: Node, index: int, written: Mapping[str, Any], at: Path) -> None:
        """Write the values onto an element, the one at `index` among the selected ones."""
        kind = kind_of(node)
        values = Values(self.editing, node, index, at=at)
        for key, item in written.items():
            path = (*at, key)
            if isinstance(item, dict):
                self._below(node, index, key, written=item, at=path)
                continue
            name, subscript = attribute_and_index(key)
            if kind.path == "body" and name == MASS:
                self._mass(values, item, path)
                continue
            attribute = kind.attributes.get(name)
            if attribute is None:
                refuse(self.editing, node, unknown_attribute(name, kind.tag, (kind,), at=path))
            if self.operation is SET and subscript is None:
                if kind.path == "joint" and name == "type":
                    check_units(values, str(values.of(item, path, values.now(attribute))), written, at=path)
                set_whole(values, attribute, item, at=path)
            else:
                compute(values, self.operation, attribute, subscript=subscript, written=item, at=path)

    def _below(self, node: Node, index: int, tag: str, written: Mapping[str, Any], at: Path) -> None:
        """Edit the child with this tag of a class or section, and create it if needed."""
        editing, kind = self.editing, kind_of(node)
        if tag not in kind.children:
            refuse(editing, node, unknown_attribute(tag, str(node.tag), (kind,), at=at))
        child = next(node.iterchildren(tag, reversed=True), None)
        if child is None:
            child = node.makeelement(tag)
            # A class's own settings come before the classes nested in it.
            node.insert(len(node) - len(list(node.iterchildren("default"))), child)
            editing.making.origins.own(child, editing.span(at, key=True))
            editing.linking.base.forget_classes()
        self.carry_out(child, index, written, at=at)

    def _mass(self, values: Values, written: Any, at: Path) -> None:
        """Change the mass of a body. Its present mass is measured only if something needs it."""
        node = values.node
        needed = not self.operation.is_factor or (isinstance(written, str) and "value" in written)
        now = self.masses.of(node, at) if needed else None
        given = values.of(written, at, now)
        if isinstance(given, bool) or not isinstance(given, int | float):
            message = f"`{MASS}` expects a number, got `{given}`"
            refuse(self.editing, node, Fault("wrong-type", message, at))
        self.masses.change(node, self.operation.verb, float(given), now=now, at=at)
