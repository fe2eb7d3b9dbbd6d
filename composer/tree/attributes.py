"""Attributes of an element, set and unset; the names of its model follow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from lxml.etree import _Element as Node

from composer.tree.classes import ORIENTATIONS
from composer.tree.editable import Editable


@contextmanager
def changing(model: Editable, node: Node) -> Iterator[None]:
    """A change of one element, after which its names are those of the model again."""
    model.forget(node)
    try:
        yield
    finally:
        model.note(node)


def assign(model: Editable, node: Node, texts: Mapping[str, str | None]) -> None:
    """Write attributes of an element of the model, None for those to take away."""
    model.forget(node)
    try:
        replace(node, texts)
    finally:
        model.note(node)


def replace(node: Node, texts: Mapping[str, str | None]) -> None:
    """Write attributes that have nothing to do with names, None for those to take away.

    There are five ways to write an orientation; each replaces the others.

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
