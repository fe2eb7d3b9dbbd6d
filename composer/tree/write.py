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
