"""A tree to MJCF text."""

from __future__ import annotations

from lxml import etree
from lxml.etree import _Element as Node


def write(root: Node) -> bytes:
    """The text of a `<mujoco>` tree: UTF-8, two spaces a level, one element a line, a final newline."""
    return to_text(root).encode()  # to bytes at once is slower in lxml


def to_text(root: Node) -> str:
    """The same, not encoded."""
    return etree.tostring(root, encoding="unicode", pretty_print=True)
