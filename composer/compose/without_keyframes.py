"""Remove the keys of a model temporarily, so that MuJoCo can compile it during an edit: their numbers no longer fit."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from lxml.etree import _Element as Node


@contextmanager
def without_keys(root: Node) -> Iterator[None]:
    """Remove the keys from a tree during the block."""
    # MuJoCo 4.0 refuses numbers that are too many for the model as it is: "keyframe 0: invalid ctrl size, expected
    # length 0".
    sections = [(root.index(section), section) for section in root.iterchildren("keyframe")]
    for _, section in sections:
        root.remove(section)
    try:
        yield
    finally:
        for at, section in sections:
            root.insert(at, section)
