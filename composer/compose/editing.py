"""The context of an edit: one model with its names, the elements that a selector finds, and the places of values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from composer.compose.edit_cost import EditCost
from composer.compose.elements import ElementBuilder
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document.node import locate
from composer.expr.value import Value
from composer.grammar.attribute import Attribute
from composer.link.layout import JOINTS
from composer.link.linking import Linking
from composer.recipe.fault import Path
from composer.recipe.motors import Motor
from composer.tree.classes import Classes
from composer.tree.effective import text_in_effect
from composer.tree.kinds import kind_of, section_of
from composer.tree.name_index import NameIndex
from composer.tree.names import WORLD
from composer.tree.removal import names_in
from composer.tree.select import name_of

if TYPE_CHECKING:
    from composer.compose.workshop import Workshop

_LAID_OUT = (*JOINTS, "default")


@dataclass(eq=False)
class Editing:
    """A model that is edited: one unit alone, or the flat one.

    `parts` has the part of each element, `scope` the values of the recipe's parameters, `motors` its data sheets.
    `cost` is what the edits of the whole composition have cost. `workshop` is where its meshes are worked on.
    """

    linking: Linking
    making: ElementBuilder
    scope: Mapping[str, Value] = field(default_factory=dict)
    parts: Mapping[Node, str] = field(default_factory=dict)
    own: bool = False
    cost: EditCost = field(default_factory=EditCost)
    motors: Mapping[str, Motor] = field(default_factory=dict)
    workshop: Workshop | None = None

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
        """The names of the model and who refers to them; the linking's names are these from now on."""
        index = NameIndex.of(self.root)
        self.linking.names.declared = index.declared
        return index

    def levels(self) -> Iterator[tuple[Editing, str]]:
        """The model alone: it is attached to nothing."""
        yield self, ""

    def find_node(self, namespace: str, name: str) -> Node | None:
        """The element of a name."""
        return self.names.find(namespace, name)

    def known_names(self, namespace: str) -> list[str]:
        """The names of a namespace."""
        return list(self.names.declared.get(namespace, ()))

    def kinds_of(self, name: str) -> list[str]:
        """The namespaces in which something has a name."""
        return self.linking.kinds_of(name)

    def may_generate(self, name: str) -> bool:
        """Whether MuJoCo may make the name itself."""
        return self.linking.may_generate(name)

    def names_of(self, node: Node) -> list[tuple[str, str]]:
        """Namespace and name of everything that goes with an element."""
        return names_in(node)

    def forget(self, node: Node) -> None:
        """Drop the names of a node that is about to change."""
        self.names.forget(node, section_of(node))

    def note(self, node: Node) -> None:
        """Take up its names again, and what else follows from a change."""
        self.names.note(node, section_of(node))
        if section_of(node) == "default":
            self.linking.base.forget_classes()
        if node.tag in _LAID_OUT or section_of(node) in ("default", "actuator"):
            self.reshaped(node)

    def reshaped(self, node: Node) -> None:
        """That a node may have another number of values in a key than before; a class may reach any."""
        changed = self.linking.keys.reshaped
        changed.add(node)
        if section_of(node) == "default":
            for section in self.root.iterchildren("worldbody", "actuator"):
                changed.update(
                    section.iter(*JOINTS) if section.tag == "worldbody" else section.iterchildren("*")
                )

    def effective(self, node: Node, name: str) -> str | None:
        """The text of an attribute in effect: written, given by a class, or MuJoCo's default."""
        return text_in_effect(node, kind_of(node), name, self.classes)

    def called(self, node: Node) -> str:
        """An element as messages name it."""
        if node.tag == "worldbody":
            return f"`{WORLD}`"
        name = name_of(node)
        tag = "default class" if node.tag == "default" else str(node.tag)
        return f"{tag} `{name}`" if name else f"a {tag} without a name"

    def subjects(self, node: Node) -> tuple[str, ...]:
        """The names that an error about an element is about."""
        name = name_of(node)
        return (name,) if name else ()

    def span(self, path: Path, key: bool = False) -> Span:
        """A place in the recipe."""
        return locate(self.making.document, path, key=key)

    def span_of(self, node: Node, attribute: str | None = None) -> Span:
        """Where an element of the model is written."""
        return self.linking.span(self.linking.base, node, attribute)

    def write(self, node: Node, places: Mapping[str, Path]) -> None:
        """Note where the new values of attributes stand in the recipe."""
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
    """Whether the values of a joint's attribute are angles."""
    return attribute.angle == "joint" and (
        joint == "hinge" or (joint == "ball" and attribute.name in ("range", "springyield"))
    )
