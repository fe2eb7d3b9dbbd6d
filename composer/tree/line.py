"""From a line of written MJCF back to the element it shows."""

from __future__ import annotations

from lxml import etree
from lxml.etree import _Element as Node


def element_at(root: Node, text: bytes, line: int) -> Node | None:
    """The element of `root` whose start tag stands on that line of `text`, which was written from `root`."""
    read = etree.fromstring(text, etree.XMLParser(remove_blank_text=True, huge_tree=True))
    for written, element in zip(read.iter("*"), root.iter("*"), strict=False):
        if written.sourceline == line:
            return element
    return None
