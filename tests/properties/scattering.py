"""Makes of a random model one whose sections stand in several pieces, in any order."""

from __future__ import annotations

from lxml.etree import _Element as Node
from properties.elements import Maker, element

_WHOLE = ("compiler", "keyframe")


def scatter(root: Node, make: Maker) -> None:
    """Split the sections of a model and shuffle the pieces; what refers to what stands before is no matter."""
    for section in [each for each in root if each.tag not in _WHOLE]:
        for _ in range(make.pick((0, 1, 1, 2))):
            children = list(section)
            if len(children) < 2:
                break
            piece = element(root, str(section.tag))
            at = make.pick(range(1, len(children)))
            piece.extend(children[at:])
    if make.chance(50):
        for section in root.iterchildren("default"):
            if make.chance(30):
                section.set("class", "main")
    pieces = [each for each in root if each.tag != "compiler"]
    make.random.shuffle(pieces)
    root.extend(pieces)
