"""Remove empty elements that exist only because they were accessed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from lxml.etree import _Element as Node

from composer.tree.classes import says_something
from composer.tree.kinds import HOLDS_ONE_OF_EACH
from composer.tree.unit import Unit


def prune(unit: Unit) -> None:
    """Remove the empty elements from the tree of a model."""
    for node in list(empty(unit)):
        while _is_empty(node) and node is not unit.root:
            parent = node.getparent()
            assert parent is not None
            parent.remove(node)
            node = parent


def empty(unit: Unit) -> Iterator[Node]:
    """Yield the empty sections and, in sections that hold one child of each tag, the empty elements below them."""
    for section in unit.root.iterchildren("*"):
        if section.tag in HOLDS_ONE_OF_EACH:
            for node in filter(_is_empty, section.iter("*")):
                if section.tag != "default" or not (says_something(node) and _is_meant(unit, node)):
                    yield node
        elif _is_empty(section):
            yield section


def _is_empty(node: Node) -> bool:
    return not len(node) and not node.keys()


def _is_meant(unit: Unit, node: Node) -> bool:
    """Return whether an element was written in a file or added by a program. Others were created on access."""
    return cast(int | None, node.sourceline) is not None or node in unit.origins.owners
