"""Remove elements: find what must be removed with them, and what can stay without them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Generic

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.tree.attributes import assign
from composer.tree.editable import M, Reference, referrers
from composer.tree.kinds import ROOT, WORLD_SECTION, section_of
from composer.tree.names import declaration

# An element still works without its class or its material, but not without anything else that it names.
DISPENSABLE = frozenset({"default", "material"})


@dataclass(frozen=True, slots=True)
class Removal(Generic[M]):
    """The outermost removed elements, each with its model, and the remaining references to them."""

    going: tuple[tuple[M, Node], ...]
    references: tuple[Reference[M], ...]

    @classmethod
    def of(cls, nodes: Iterable[tuple[M, Node]]) -> Removal[M]:
        """Return the removal of these elements alone."""
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
        """Return the removal with all elements that depend on removed ones; the remaining references can be dropped."""
        removal = self
        while falling := [
            (each.model, whole(each.node))
            for each in removal.references
            if not can_do_without(each.node, each.namespace)
        ]:
            removal = Removal.of([*removal.going, *falling])
        return removal

    def drop_references(self) -> None:
        """Remove the attributes that refer to removed elements."""
        for model, node, attribute, *_ in self.references:
            assign(model, node, {attribute: None})


def _outermost(nodes: Iterable[tuple[M, Node]]) -> tuple[tuple[M, Node], ...]:
    """Return each node once, without those inside another one."""
    models = {node: model for model, node in nodes}
    return tuple(
        (model, node)
        for node, model in models.items()
        if not any(above in models for above in node.iterancestors())
    )


def whole(node: Node) -> Node:
    """Return the smallest meaningful element around a node.

    That is a section's direct child, or in the body tree the element itself.
    """
    if section_of(node) == WORLD_SECTION:
        return node
    while (parent := node.getparent()) is not None and not is_section(parent):
        node = parent
    return node


def is_section(node: Node) -> bool:
    """Return whether the element is a section of its model."""
    parent = node.getparent()
    return parent is not None and parent.tag == ROOT


def can_do_without(node: Node, namespace: str) -> bool:
    """Return whether an element works without its reference to something of that namespace."""
    return namespace in DISPENSABLE or section_of(node) == "default"


def names_in(node: Node) -> list[tuple[str, str]]:
    """Return namespace and name of everything that an element and its contents declare."""
    section = section_of(node)
    found = [declaration(each, section) for each in node.iter("*") if not is_section(each)]
    return [each for each in found if each is not None]
