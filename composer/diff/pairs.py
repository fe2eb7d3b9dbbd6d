"""Pairs of elements, one of each model, that may be the cause of a difference."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import zip_longest
from typing import TYPE_CHECKING, TypeAlias

from composer.compiled.quantities import quantity
from composer.diff.change import Change
from composer.diff.elements import Elements

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

INERTIAL = frozenset({"body_mass", "body_inertia", "body_ipos", "body_iquat", "body_subtreemass"})
ASSETS = {"mesh": "mesh", "material": "material", "hfield": "hfield", "texture": "texture"}
_TARGETS = {"joint": "joint", "jointinparent": "joint", "tendon": "tendon"}
_PATH = {"site": "site", "geom": "geom", "sidesite": "site", "joint": "joint"}
_POSE = quantity("body_pos").attributes
_AT_POSE = ("body_ipos", "body_iquat")
"""MuJoCo 3.12 to 4.0 copy the pose of a body that has no mass here."""

Pair: TypeAlias = "tuple[Node | None, Node | None, tuple[str, ...] | None]"
"""An element of A, its counterpart in B, and the attributes to compare; None for all."""


class Pairs:
    """Finds pairs in both models."""

    def __init__(self, a: Elements, b: Elements) -> None:
        self.a, self.b = a, b

    def candidates(
        self, change: Change, before: Node, after: Node, wanted: tuple[str, ...]
    ) -> Iterator[Pair]:
        """Yield possible causes, the likeliest first."""
        if change.field in INERTIAL:
            for tag in ("inertial", "geom"):
                for mine, theirs in zip_longest(self.a.inside(before, tag), self.b.inside(after, tag)):
                    yield mine, theirs, None
                    yield from self.referred(mine, theirs, ASSETS)
            if change.field in _AT_POSE and not (self.a.weighs(before) or self.b.weighs(after)):
                pose = quantity(change.field.replace("body_i", "body_")).attributes
                yield before, after, pose
                yield from self.frames(before, after, pose)
            return
        yield before, after, wanted
        if "pos" in wanted or change.field.endswith(("_bodyid", "_parentid")):
            yield from self.frames(before, after, wanted or _POSE)
        yield before, after, tuple(ASSETS)
        yield from self.referred(before, after, ASSETS)
        if change.kind == "actuator":
            yield before, after, tuple(_TARGETS)
            for mine, theirs, _ in self.referred(before, after, _TARGETS):
                yield mine, theirs, ("range", "ref", "type", "axis")
        yield before, after, None
        if change.kind == "tendon":
            for mine, theirs in zip_longest(before.iterchildren("*"), after.iterchildren("*")):
                yield mine, theirs, None
            for mine, theirs in zip(before.iterchildren("*"), after.iterchildren("*"), strict=False):
                for first, second, _ in self.referred(mine, theirs, _PATH):
                    yield first, second, None
                    yield from self.above(first, second)

    def frames(self, before: Node, after: Node, wanted: tuple[str, ...]) -> Iterator[Pair]:
        """Yield the frames around an element up to its body, and the places of parts that they or it are made for."""
        around = zip_longest(self.a.frames(before)[::-1], self.b.frames(after)[::-1])
        for mine, theirs in (*around, (before, after)):
            if mine is not before:
                yield mine, theirs, wanted
            places = [
                None if node is None else side.place(node)
                for side, node in ((self.a, mine), (self.b, theirs))
            ]
            if None not in places:
                yield places[0], places[1], wanted

    def above(self, before: Node | None, after: Node | None) -> Iterator[Pair]:
        """Yield all bodies and frames around an element, up to the world."""
        while before is not None and after is not None:
            yield from self.frames(before, after, _POSE)
            before, after = (next(each.iterancestors("body"), None) for each in (before, after))
            if before is not None and after is not None:
                yield before, after, _POSE

    def referred(self, before: Node | None, after: Node | None, kinds: Mapping[str, str]) -> Iterator[Pair]:
        """Yield the mesh, material, joint, … that both refer to; `kinds` has its kind by attribute."""
        if before is None or after is None:
            return
        for attribute, kind in kinds.items():
            mine, _ = self.a.value(before, attribute)
            theirs, _ = self.b.value(after, attribute)
            if mine and theirs:
                yield self.a.node(kind, mine, -1), self.b.node(kind, theirs, -1), None

    def holding(self, before: Node | None, after: Node | None) -> Iterator[Pair]:
        """Yield the body of a joint and everything around it; an actuator by itself."""
        if before is None or after is None:
            return
        yield before, after, ("ref",)
        mine, theirs = _body(before), _body(after)
        if mine is not None and theirs is not None:
            yield mine, theirs, _POSE
            yield from self.above(mine, theirs)


def _body(node: Node | None) -> Node | None:
    """Return the body itself, or the body of a joint."""
    if node is None or node.tag == "body":
        return node
    return next(node.iterancestors("body"), None)
