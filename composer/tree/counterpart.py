"""Find the copy of a node in a copied tree."""

from __future__ import annotations

from lxml.etree import _Element as Node


def counterpart(node: Node, root: Node, copied: Node) -> Node:
    """Return the node of `copied`, a deep copy of `root`, at the position of `node` below `root`."""
    steps: list[int] = []
    while node is not root:
        parent = node.getparent()
        assert parent is not None
        steps.append(parent.index(node))
        node = parent
    for step in reversed(steps):
        copied = copied[step]
    return copied
