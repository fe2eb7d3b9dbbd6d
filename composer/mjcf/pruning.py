"""Elements that are there because somebody only looked at them, and that mean nothing."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.tree.kinds import HOLDS_ONE_OF_EACH


def prune(root: Node) -> None:
    """Take the empty ones out of a `<mujoco>` tree."""
    for node in list(empty(root)):
        while _is_empty(node) and node is not root:
            parent = node.getparent()
            assert parent is not None
            parent.remove(node)
            node = parent


def empty(root: Node) -> Iterator[Node]:
    """The sections without anything, and, in those that hold one of each, what is below them."""
    for section in root.iterchildren("*"):
        if section.tag in HOLDS_ONE_OF_EACH:
            yield from filter(_is_empty, section.iter("*"))
        elif _is_empty(section):
            yield section


def _is_empty(node: Node) -> bool:
    return not len(node) and not node.keys()
