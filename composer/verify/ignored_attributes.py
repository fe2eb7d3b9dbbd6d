"""What MuJoCo's reader passes over without a word: attributes of `<frame>` and `<replicate>` that MJCF does not have.

Everywhere else it refuses them. Parts are joined by frames, so that a typing error in a source, which MuJoCo tells of
the source alone, would be lost in a composition.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_BLIND = ("frame", "replicate")


def unread(root: Node) -> Iterator[tuple[Node, str]]:
    """Elements with the name of each of their attributes that nobody reads. No I/O."""
    for worldbody in root.iterchildren("worldbody"):
        yield from _below(worldbody, GRAMMAR.section("worldbody"), False)


def _below(parent: Node, kind: ElementType, blind: bool) -> Iterator[tuple[Node, str]]:
    stack = [(parent, kind, blind)]
    while stack:
        parent, kind, blind = stack.pop()
        for child in parent.iterchildren("*"):
            child_kind = kind.children.get(str(child.tag))
            if child_kind is None:
                continue
            unseen = blind or child.tag in _BLIND
            if unseen:
                known = child_kind.attributes
                yield from ((child, str(name)) for name in child.keys() if name not in known)  # noqa: SIM118
            if len(child):
                stack.append((child, child_kind, unseen))
