"""Write a tree as MJCF text."""

from __future__ import annotations

from lxml import etree
from lxml.etree import _Element as Node


def write(root: Node) -> bytes:
    """Return the text of a `<mujoco>` tree: UTF-8, indented by two spaces, an element a line, a final newline."""
    return to_text(root).encode()  # writing bytes directly is slower in lxml


def to_text(root: Node) -> str:
    """Return the text of a `<mujoco>` tree, not encoded."""
    return etree.tostring(root, encoding="unicode", pretty_print=True)


def as_it_is(node: Node) -> bytes:
    """Return the text of a tree without a new line or space: two trees with the same text say the same."""
    return etree.tostring(node, encoding="utf-8", with_tail=False)
