"""Frames that resize their contents (`scale`, MuJoCo 3.16 and later)."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node


def scales(frame: Node) -> bool:
    """Return whether a frame changes sizes or masses.

    >>> from lxml.etree import fromstring
    >>> scales(fromstring('<frame scale="1 1 1"/>')), scales(fromstring('<frame scale="2"/>'))
    (False, True)
    """
    factors = str(frame.get("scale") or "1").split()
    return any(float(factor) != 1 for factor in factors) or bool(float(str(frame.get("massscale") or 0)))


def scaled_above(element: Node | None) -> Node | None:
    """Return the nearest frame that resizes `element`, which may be that frame itself."""
    return next(all_scaled_above(element), None)


def all_scaled_above(element: Node | None) -> Iterator[Node]:
    """Yield the frames that resize `element`, innermost first."""
    while element is not None:
        if element.tag == "frame" and scales(element):
            yield element
        element = element.getparent()


def first_scaled(root: Node) -> Node | None:
    return next((frame for frame in root.iter("frame") if scales(frame)), None)
