"""Flexes that MuJoCo 3 does not move with the frames around them. MuJoCo 4 moves them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from composer.grammar.version import version_key
from composer.tree.classes import ORIENTATIONS

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_MOVING = frozenset({"pos", *ORIENTATIONS})


def unmoved_flexes(root: Node, mujoco: str | None) -> Iterator[Node]:
    """Yield the flexes inside of posed frames, if this version of MuJoCo ignores these poses. No I/O."""
    if mujoco is None or version_key(mujoco) >= (4,):
        return
    for flex in root.iter("flexcomp"):
        around = flex.getparent()
        while around is not None and around.tag in ("frame", "replicate"):
            if around.tag == "frame" and not _MOVING.isdisjoint(around.keys()):
                yield flex
                break
            around = around.getparent()
