"""The order in which the sections of a model stand, for whom a new one is made."""

from __future__ import annotations

from lxml.etree import _Element as Node

# That of MuJoCo's XML reference, which means nothing to MuJoCo; but a reader expects it.
_SECTIONS = (
    "compiler option size visual statistic default extension custom asset worldbody deformable contact tendon"
    " equality actuator sensor keyframe"
).split()
_RANK = {tag: rank for rank, tag in enumerate(_SECTIONS)}


def place_of(root: Node, tag: str) -> int:
    """Where among the children of `root` a new section goes: behind all those that come before it by custom."""
    rank = _RANK.get(tag, len(_RANK))
    at = 0
    for index, child in enumerate(root):
        if isinstance(child.tag, str) and _RANK.get(child.tag, 0) <= rank:
            at = index + 1
    return at
