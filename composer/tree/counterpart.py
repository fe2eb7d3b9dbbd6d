"""A node and the one that stands for it in a copy of its tree."""

from __future__ import annotations

from lxml.etree import _Element as Node


def counterpart(node: Node, root: Node, copied: Node) -> Node:
    """The node of `copied`, a deep copy of `root`, that stands where `node` does below `root`."""
    steps: list[int] = []
    while node is not root:
        parent = node.getparent()
        assert parent is not None
        steps.append(parent.index(node))
        node = parent
    for step in reversed(steps):
        copied = copied[step]
    return copied
