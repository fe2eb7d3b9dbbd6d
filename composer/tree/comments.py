"""Comments of a model, and which of them move to another model with the section below them."""

from __future__ import annotations

from collections.abc import Container

from lxml.etree import _Comment as Comment
from lxml.etree import _Element as Node


def take_header_in(root: Node) -> tuple[Node, ...]:
    """Move the comments before a root, such as a licence, inside of it.

    Otherwise they would be lost when the tree moves.
    """
    found = [each for each in root.itersiblings(preceding=True) if isinstance(each, Comment)]
    for comment in found:
        comment.tail = None
        root.insert(0, comment)
    return tuple(reversed(found))


def above(section: Node, header: Container[Node]) -> list[Node]:
    """Return the comments directly above a section, except those of the header."""
    found: list[Node] = []
    for sibling in section.itersiblings(preceding=True):
        if not isinstance(sibling, Comment) or sibling in header:
            break
        found.append(sibling)
    return found[::-1]
