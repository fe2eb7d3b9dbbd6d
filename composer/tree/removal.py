"""What must go with an element, and what can do without it."""

from __future__ import annotations

from collections.abc import Iterable

from lxml.etree import _Element as Node

from composer.tree.kinds import ROOT, WORLD_SECTION, section_of
from composer.tree.name_index import NameIndex, Use
from composer.tree.names import declaration

# An element is still one without its class or its material; without anything else that it names it is not.
DISPENSABLE = frozenset({"default", "material"})


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


def referrers(index: NameIndex, going: Iterable[Node]) -> list[tuple[Use, str, str]]:
    """Who refers to what is going, and stays: element and attribute, and namespace and name of what it names."""
    nodes = list(going)
    inside = {each for node in nodes for each in node.iter("*")}
    return [
        (use, namespace, name)
        for node in nodes
        for namespace, name in names_in(node)
        if index.find(namespace, name) in inside
        for use in users(index, namespace, name)
        if use[0] not in inside
    ]


def users(index: NameIndex, namespace: str, name: str) -> list[Use]:
    """Who refers to a name, or to one of those that MuJoCo makes of it where it stands in a `replicate`."""
    found = index.users(namespace, name)
    node = index.find(namespace, name)
    if node is not None and (multiplies(node)):
        for other in list(index.uses.get(namespace, {})):
            if is_copy(other, name) and index.find(namespace, other) is None:
                found += index.users(namespace, other)
    return found


def multiplies(node: Node) -> bool:
    """Whether MuJoCo makes several names of the element's own."""
    return node.tag in ("flexcomp", "composite") or next(node.iterancestors("replicate"), None) is not None


def is_copy(other: str, name: str) -> bool:
    """Whether a name is what MuJoCo makes of another one, with numbers behind it.

    >>> is_copy("pad_012", "pad"), is_copy("pad3_0", "pad3"), is_copy("padding", "pad")
    (True, True, False)
    """
    return other.startswith(name) and len(other) > len(name) and other[-1].isdigit()
