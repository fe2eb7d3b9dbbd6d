"""Set and remove attributes of an element, and keep the names of its model up to date."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from lxml.etree import _Element as Node

from composer.tree.classes import ORIENTATIONS
from composer.tree.editable import Editable


@contextmanager
def changing(model: Editable, node: Node) -> Iterator[None]:
    """Update the names of the model after a change of one element in the block."""
    model.forget(node)
    try:
        yield
    finally:
        model.note(node)


def assign(model: Editable, node: Node, texts: Mapping[str, str | None]) -> None:
    """Write attributes of an element of the model; None removes one."""
    model.forget(node)
    try:
        replace(node, texts)
    finally:
        model.note(node)


def replace(node: Node, texts: Mapping[str, str | None]) -> None:
    """Write attributes that hold no names; None removes one.

    There are five attributes for an orientation; each replaces the others.

    >>> from lxml import etree
    >>> geom = etree.fromstring('<geom size="1" euler="0 0 90"/>')
    >>> replace(geom, {"size": None, "quat": "1 0 0 0"})
    >>> etree.tostring(geom)
    b'<geom quat="1 0 0 0"/>'
    """
    for name, text in texts.items():
        if text is None:
            node.attrib.pop(name, "")
            continue
        if name in ORIENTATIONS:
            for other in ORIENTATIONS:
                node.attrib.pop(other, "")
        node.set(name, text)
