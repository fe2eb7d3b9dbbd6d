"""The conventional order of a model's sections, for inserting a new one."""

from __future__ import annotations

from lxml.etree import _Element as Node

# The order of MuJoCo's XML reference. MuJoCo ignores it, but readers expect it.
_SECTIONS = (
    "compiler option size visual statistic default extension custom asset worldbody deformable contact tendon"
    " equality actuator sensor keyframe"
).split()
_RANK = {tag: rank for rank, tag in enumerate(_SECTIONS)}


def place_of(root: Node, tag: str) -> int:
    """Return the index of a new section among the children of `root`: behind all that conventionally precede it."""
    rank = _RANK.get(tag, len(_RANK))
    at = 0
    for index, child in enumerate(root):
        if isinstance(child.tag, str) and _RANK.get(child.tag, 0) <= rank:
            at = index + 1
    return at
