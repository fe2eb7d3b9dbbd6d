"""The context of an edit: the model, its names, and the cost of editing."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from functools import cached_property
from pathlib import Path as PathlibPath
from typing import Any

from lxml.etree import _Element as Node
from pydantic import BaseModel

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path, Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.build.compose.elements import ElementBuilder
from mjcompose.language.datasheets import Sheet
from mjcompose.link.key_layout import JOINTS
from mjcompose.link.linking import Linking
from mjcompose.link.submodels import add_named_file
from mjcompose.text.expression import Value
from mjcompose.text.node import locate
from mjcompose.tree.classes import Classes, text_in_effect
from mjcompose.tree.cost import written
from mjcompose.tree.edit import changing, names_in
from mjcompose.tree.files import written_path
from mjcompose.tree.grammar import Attribute
from mjcompose.tree.names import WORLD, NameIndex
from mjcompose.tree.pattern import Selector, is_regular
from mjcompose.tree.select import kind_of, name_of, section_of

# Measured: in the 0.1 ms in which a value is written, a selector visits 30 elements, 100 characters of a condition are
# evaluated, and 100 values are drawn, or 30 for a table. A regular expression may take 2 s, and costs 500 values.
_LOOKS, _CHARACTERS, _EXPRESSION, _DRAWS, _DRAWS_OF_A_TABLE = 30, 100, 500, 100, 30


@dataclass(slots=True)
class EditCost:
    """The cost of all edits of one composition so far; `ended` is set once it exceeds the limit.

    The unit is the time in which one value is written.
    """

    spent: float = 0
    ended: bool = False

    def allows(self, cost: float, sink: Sink, span: Span) -> bool:
        """Add a cost. Return False if the limit is exceeded, which is reported the first time."""
        self.spent += cost
        most = in_force().edits
        if self.spent > most and not self.ended:
            self.ended = True
            message = f"the edits up to here cost as much as {self.spent:.0f} values; {most} are allowed"
            help = advice("edits", max(2 * most, int(self.spent) + 1))
            sink.error("limit-exceeded", message, span, help=help)
        return not self.ended


def cost_of_selecting(selector: Selector, root: Node) -> float:
    """Return the cost of finding the elements of a selector."""
    selectors = list(selector.all())
    looks = 0 if selector.is_one_name else len(selectors) * written(root)
    expressions = sum(is_regular(name) for each in selectors for name in (each.pattern, each.dclass or ""))
    return _EXPRESSION * expressions + looks / _LOOKS


def cost_of_condition(where: Mapping[str, object] | str | None) -> float:
    """Return the cost of evaluating a condition on one element."""
    return len(where) / _CHARACTERS if isinstance(where, str) else len(where or ())


def count_values(value: Any) -> int:
    """Return how many values an entry writes for each element.

    >>> from mjcompose.build.verbs.set import Set
    >>> count_values({"set": Set.model_validate({"size": [0.1, 0.2], "rgba": [1, 0, 0, 1]})})
    2
    """
    if isinstance(value, BaseModel):
        return sum(count_values(getattr(value, name)) for name in value.model_fields_set)
    return sum(map(count_values, value.values())) if isinstance(value, Mapping) else 1


def cost_of_draws(samples: int, tabled: bool) -> float:
    """Return the cost of checking the draws of all samples for one element, and of tabulating them."""
    return 1 + samples / (_DRAWS_OF_A_TABLE if tabled else _DRAWS)


_LAID_OUT = (*JOINTS, "default")


@dataclass(eq=False)
class Editing:
    """A model that is edited: one unit alone, or the flat one.

    `parts` has the part of each element, `scope` the values of the recipe's parameters, `datasheets` its data sheets.
    `cost` is the cost of all edits of the composition.
    """

    linking: Linking
    making: ElementBuilder
    scope: Mapping[str, Value] = field(default_factory=dict)
    parts: Mapping[Node, str] = field(default_factory=dict)
    own: bool = False
    cost: EditCost = field(default_factory=EditCost)
    datasheets: Mapping[str, Sheet] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.linking.keys.edited = True

    @property
    def root(self) -> Node:
        return self.linking.base.root

    @property
    def sink(self) -> Sink:
        return self.making.sink

    @property
    def classes(self) -> Classes:
        return self.linking.base.classes

    @cached_property
    def names(self) -> NameIndex:
        """The index of the model's names and references. From the first access on, the linking uses it too."""
        index = NameIndex.of(self.root)
        self.linking.names.declared = index.declared
        return index

    def levels(self) -> Iterator[tuple[Editing, str]]:
        """Yield only the model itself, which is not attached to anything."""
        yield self, ""

    def find_node(self, namespace: str, name: str) -> Node | None:
        """Return the element with this name, or None."""
        return self.names.find(namespace, name)

    def known_names(self, namespace: str) -> list[str]:
        """Return the names in a namespace."""
        return list(self.names.declared.get(namespace, ()))

    def kinds_of(self, name: str) -> list[str]:
        """Return the namespaces in which the name exists."""
        return self.linking.kinds_of(name)

    def may_generate(self, name: str) -> bool:
        """Return whether MuJoCo may generate the name itself."""
        return self.linking.may_generate(name)

    def names_of(self, node: Node) -> list[tuple[str, str]]:
        """Return the namespace and name of everything in an element's subtree."""
        return names_in(node)

    def forget(self, node: Node) -> None:
        """Remove the names of a node from the index before the node changes."""
        self.names.forget(node, section_of(node))

    def note(self, node: Node) -> None:
        """Add the names of a changed node to the index, and record the other effects of the change."""
        self.names.note(node, section_of(node))
        self._has_changed(node)

    @contextmanager
    def writing(self, node: Node, attribute: Attribute) -> Iterator[None]:
        """Keep the facts about a node up to date while an attribute of it is written."""
        if not attribute.is_number:
            with changing(self, node):
                yield
            return
        yield  # numbers are not names, so the index is not needed, which needs a walk over the model
        if node.tag == "key":
            self.linking.keys.edited_keys.add(node)
        self._has_changed(node)

    def _has_changed(self, node: Node) -> None:
        if section_of(node) == "default":
            self.linking.base.forget_classes()
        if node.tag in _LAID_OUT or section_of(node) in ("default", "actuator"):
            self.reshaped(node)
        for flex in (node, *node.iterancestors("flexcomp")):  # its grid, pins, degrees of freedom
            if flex.tag == "flexcomp":
                self.reshaped(flex)

    def reshaped(self, node: Node) -> None:
        """Record that a node may have another number of values in a key than before. A class may affect any node."""
        changed = self.linking.keys.reshaped
        changed.add(node)
        if section_of(node) == "default":
            for section in self.root.iterchildren("worldbody", "actuator"):
                changed.update(section.iter(*JOINTS) if section.tag == "worldbody" else section.iterchildren("*"))

    def effective(self, node: Node, name: str) -> str | None:
        """Return the effective text of an attribute: the written text, a class's text, or MuJoCo's default."""
        return text_in_effect(node, kind_of(node), name, classes=self.classes)

    def called(self, node: Node) -> str:
        """Return the description of an element for messages."""
        if node.tag == "worldbody":
            return f"`{WORLD}`"
        name = name_of(node)
        tag = "default class" if node.tag == "default" else str(node.tag)
        return f"{tag} `{name}`" if name else f"a {tag} without a name"

    def subjects(self, node: Node) -> tuple[str, ...]:
        """Return the names that an error about an element concerns."""
        name = name_of(node)
        return (name,) if name else ()

    def span(self, path: Path, key: bool = False) -> Span:
        """Return a place in the recipe."""
        return locate(self.making.document, path, key=key)

    def span_of(self, node: Node, attribute: str | None = None) -> Span:
        """Return where an element of the model is written."""
        return self.linking.span(self.linking.base, node, attribute)

    def write(self, node: Node, places: Mapping[str, Path]) -> None:
        """Record where the new values of attributes are in the recipe."""
        before = self.making.origins.owner(node, self.making.base_file)

        def place(attribute: str | None) -> Span:
            if attribute is not None and attribute in places:
                return self.span(places[attribute])
            return self.making.origins.span_by(before, node, attribute)

        self.making.origins.own(node, place)
        settings = self.making.origins.settings.get(node, {})
        for name in places:
            settings.pop(name, None)


def is_angular(attribute: Attribute, joint: str) -> bool:
    """Return whether the values of a joint's attribute are angles."""
    return attribute.angle == "joint" and (
        joint == "hinge" or (joint == "ball" and attribute.name in ("range", "springyield"))
    )


def take_files(editing: Editing) -> None:
    """Resolve the files that edits name relative to the recipe. They replace those that the elements named before."""
    making, linking = editing.making, editing.linking
    for node, attribute, name in making.files:
        file = making.named_file(node, attribute, name)
        linking.files = [use for use in linking.files if use.element is not node or use.attribute != attribute]
        if not editing.own:
            add_named_file(linking, file)
            continue
        # The part's own access rules do not apply, because the recipe names the file.
        path, unit = PathlibPath(os.path.realpath(file.folder / file.name)), linking.base
        try:
            file.door.admit(path)
        except Refused as refused:
            refused.report(editing.sink, file.span)
            continue
        node.set(attribute, path.as_posix())
        unit.contents = {**unit.contents, written_path(unit.settings, node, path.as_posix()): path}
    making.files.clear()
