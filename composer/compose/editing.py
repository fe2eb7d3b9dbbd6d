"""The context of an edit: one model with its names, the elements that a selector finds, and the places of values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from functools import cached_property

from lxml.etree import _Element as Node

from composer.compose.edit_cost import EditCost
from composer.compose.elements import ElementBuilder
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document.node import locate
from composer.expr.value import Value
from composer.grammar.attribute import Attribute
from composer.link.layout import JOINTS
from composer.link.linking import Linking
from composer.recipe.fault import Path
from composer.recipe.motors import Motor
from composer.tree.attributes import changing
from composer.tree.classes import Classes
from composer.tree.effective import text_in_effect
from composer.tree.kinds import kind_of, section_of
from composer.tree.name_index import NameIndex
from composer.tree.names import WORLD
from composer.tree.removal import names_in
from composer.tree.select import name_of

_LAID_OUT = (*JOINTS, "default")


@dataclass(eq=False)
class Editing:
    """A model that is edited: one unit alone, or the flat one.

    `parts` has the part of each element, `scope` the values of the recipe's parameters, `motors` its data sheets.
    `cost` is what the edits of the whole composition have cost.
    """

    linking: Linking
    making: ElementBuilder
    scope: Mapping[str, Value] = field(default_factory=dict)
    parts: Mapping[Node, str] = field(default_factory=dict)
    own: bool = False
    cost: EditCost = field(default_factory=EditCost)
    motors: Mapping[str, Motor] = field(default_factory=dict)

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
        """Keep what is known of a node up to date while an attribute of it is written."""
        if not attribute.is_number:
            with changing(self, node):
                yield
            return
        yield  # numbers are no names: the index, which takes a walk over the model to make, is not needed
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
                changed.update(
                    section.iter(*JOINTS) if section.tag == "worldbody" else section.iterchildren("*")
                )

    def effective(self, node: Node, name: str) -> str | None:
        """Return the effective text of an attribute: the written one, that of a class, or MuJoCo's default."""
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
