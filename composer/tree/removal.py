"""Taking elements out: what must go with them, and what can do without them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic

from lxml.etree import _Element as Node

from composer.tree.attributes import assign
from composer.tree.editable import M, Reference, referrers
from composer.tree.kinds import ROOT, WORLD_SECTION, section_of
from composer.tree.names import declaration

# An element is still one without its class or its material; without anything else that it names it is not.
DISPENSABLE = frozenset({"default", "material"})


@dataclass(frozen=True, slots=True)
class Removal(Generic[M]):
    """What goes, each with its model and none inside another, and who of the rest refers to it."""

    going: tuple[tuple[M, Node], ...]
    references: tuple[Reference[M], ...]

    @classmethod
    def of(cls, nodes: Iterable[tuple[M, Node]]) -> Removal[M]:
        """These elements alone."""
        going = _outermost(nodes)
        inside = {each for _, node in going for each in node.iter("*")}
        found = dict.fromkeys(
            reference
            for model, node in going
            for namespace, name in model.names_of(node)
            if (there := model.names.find(namespace, name)) is None or there in inside
            for reference in referrers(model, namespace, name)
            if reference.node not in inside
        )
        return cls(going, tuple(found))

    def with_referrers(self) -> Removal[M]:
        """With everything that refers to them and cannot do without; the references that are left can be dropped."""
        removal = self
        while falling := [
            (each.model, whole(each.node))
            for each in removal.references
            if not can_do_without(each.node, each.namespace)
        ]:
            removal = Removal.of([*removal.going, *falling])
        return removal

    def drop_references(self) -> None:
        """Take away the attributes that refer to what goes."""
        for model, node, attribute, *_ in self.references:
            assign(model, node, {attribute: None})


def _outermost(nodes: Iterable[tuple[M, Node]]) -> tuple[tuple[M, Node], ...]:
    """Each node once, none that is inside another."""
    models = {node: model for model, node in nodes}
    return tuple(
        (model, node)
        for node, model in models.items()
        if not any(above in models for above in node.iterancestors())
    )


def whole(node: Node) -> Node:
    """What makes sense only as a whole: a section's direct child, in the body tree the element itself."""
    if section_of(node) == WORLD_SECTION:
        return node
    while (parent := node.getparent()) is not None and not is_section(parent):
        node = parent
    return node


def is_section(node: Node) -> bool:
    """Whether the element is a section of its model."""
    parent = node.getparent()
    return parent is not None and parent.tag == ROOT


def can_do_without(node: Node, namespace: str) -> bool:
    """Whether an element stays one if its reference to something of that namespace is taken away."""
    return namespace in DISPENSABLE or section_of(node) == "default"


def names_in(node: Node) -> list[tuple[str, str]]:
    """Namespace and name of everything that an element and what is in it declare."""
    section = section_of(node)
    found = [declaration(each, section) for each in node.iter("*") if not is_section(each)]
    return [each for each in found if each is not None]
