"""Line numbers of elements, in the file they were read from and in the text they are written to."""

from __future__ import annotations

from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

_LAST_LINE = 65535


def line_of(element: Node) -> int | None:
    """Return the line on which the element's start tag ends in its file, or None if it was not read from a file."""
    line: Any = element.sourceline
    return line if isinstance(line, int) else None


def set_line(element: Node, line: int | None) -> None:
    """Set the line of a created element, as far as lxml allows."""
    if line is not None and line <= _LAST_LINE:
        element.sourceline = line  # type: ignore[assignment]  # the stubs know it as read alone


def element_at(root: Node, text: bytes, line: int) -> Node | None:
    """Return the element of `root` whose start tag is on that line of `text`, which was written from `root`."""
    read = etree.fromstring(text, etree.XMLParser(remove_blank_text=True, huge_tree=True))
    for written, element in zip(read.iter("*"), root.iter("*"), strict=False):
        if written.sourceline == line:
            return element
    return None
