"""Which line makes a difference: the attribute that is not the same in both trees, and where it is written."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from itertools import zip_longest
from typing import TYPE_CHECKING, TypeAlias

from composer.diagnostics.span import Span
from composer.diff.change import SETTINGS, Cause, Change, Contrast
from composer.diff.elements import Elements
from composer.diff.excerpt import block, different
from composer.diff.fields import quantity
from composer.diff.said import said
from composer.diff.side import Side
from composer.document.node import locate
from composer.explain.query import name_of
from composer.tree.kinds import kind_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.link.linking import Part

_INERTIAL = frozenset({"body_mass", "body_inertia", "body_ipos", "body_iquat", "body_subtreemass"})
Pair: TypeAlias = "tuple[Node | None, Node | None, tuple[str, ...] | None]"
"""An element of A, the one of B that it is there, and the attributes in question; None for any."""

_NO_REASON = ("name", "class", "childclass")
_ASSETS = {"mesh": "mesh", "material": "material", "hfield": "hfield", "texture": "texture"}
_TARGETS = {"joint": "joint", "jointinparent": "joint", "tendon": "tendon"}


class Causes:
    """Looks things up in both trees, which `found` is the contrast of."""

    def __init__(self, a: Side, b: Side, found: Contrast) -> None:
        counts = found.elements
        self.alone: set[tuple[int, str | None]] = {
            (("removed", "added").index(each.what), each.name)
            for each in found.changes
            if each.kind == "body" and each.what in ("removed", "added")
        }
        self.sides = a, b
        self.a = (
            None if a.traced is None else Elements(a.traced, {kind: n for kind, (n, _) in counts.items()})
        )
        self.b = (
            None if b.traced is None else Elements(b.traced, {kind: n for kind, (_, n) in counts.items()})
        )
        self.parts = _parts(a), _parts(b)

    def of(self, change: Change) -> Cause | None:
        """The cause of a change; None where no line is known."""
        if change.kind.partition("/")[0] in SETTINGS:
            return self._setting(change)
        if change.what == "changed" and change.kind == "key" and change.entry:
            return self._entry(change)
        before, after = self._nodes(change)
        if change.what == "added":
            return self._one_sided(after, 1)
        if change.what == "removed":
            return self._one_sided(before, 0)
        if before is None or after is None:
            return None
        if (swapped := self._swapped(after)) is not None:
            return swapped
        if change.what == "renamed":
            return self._renamed(before, after)
        return self._changed(change, before, after)

    def _nodes(self, change: Change) -> tuple[Node | None, Node | None]:
        first, second = change.index
        return (
            None if self.a is None else self.a.node(change.kind, change.name_before, first),
            None if self.b is None else self.b.node(change.kind, change.name, second),
        )

    # -- what both have ----------------------------------------------------------------------------------------

    def _changed(self, change: Change, before: Node, after: Node) -> Cause | None:
        wanted = quantity(change.field).attributes
        if "pos" in wanted and (attached := self._attached(before, after)) is not None:
            return attached
        for mine, theirs, attributes in self._reasons(change, before, after, wanted):
            cause = self._attribute(mine, theirs, attributes)
            if cause is not None:
                return cause
        return self._content(change, before, after)

    def _swapped(self, after: Node) -> Cause | None:
        """The part of another model, where both sides have a part of that name."""
        part = self._part(1, after)
        there = None if part is None else self.parts[0].get(part.called)
        return None if part is None or there is None else Cause(f"part `{part.called}`", there[0], part.span)

    def _content(self, change: Change, before: Node, after: Node) -> Cause | None:
        """The file that is named as before and has other bytes, of the element or the asset that it refers to."""
        pairs: list[Pair] = [(before, after, None), *self._referred(before, after, _ASSETS)]
        if change.field in _INERTIAL:
            assert self.a is not None and self.b is not None
            for geom, other in zip(self.a.inside(before, "geom"), self.b.inside(after, "geom"), strict=False):
                pairs += self._referred(geom, other, _ASSETS)
        for mine, theirs, _ in pairs:
            files = [None if node is None else node.get("file") for node in (mine, theirs)]
            digests = [side.digests.get(str(file)) for side, file in zip(self.sides, files, strict=True)]
            if None not in digests and digests[0] != digests[1]:
                words = f"`{files[1]}` has other bytes"
                return Cause(words, self._span(0, mine, "file"), self._span(1, theirs, "file"))
        return None

    def _reasons(self, change: Change, before: Node, after: Node, wanted: tuple[str, ...]) -> Iterator[Pair]:
        """What may be the reason, the likeliest first."""
        assert self.a is not None and self.b is not None
        if change.field in _INERTIAL:
            for tag in ("inertial", "geom"):
                for mine, theirs in zip_longest(self.a.inside(before, tag), self.b.inside(after, tag)):
                    yield mine, theirs, None
                    yield from self._referred(mine, theirs, _ASSETS)
            return
        yield before, after, wanted
        if "pos" in wanted:
            yield from self._frames(before, after)
        yield from self._referred(before, after, _ASSETS)
        if change.kind == "actuator":
            for mine, theirs, _ in self._referred(before, after, _TARGETS):
                yield mine, theirs, ("range", "ref", "type", "axis")
        yield before, after, None
        if change.kind == "tendon":
            for mine, theirs in zip_longest(before.iterchildren("*"), after.iterchildren("*")):
                yield mine, theirs, None

    def _attached(self, before: Node, after: Node) -> Cause | None:
        """The lines that attach a part to its place, where these are not the same."""
        assert self.a is not None and self.b is not None
        for mine, theirs in zip(self.a.frames(before), self.b.frames(after), strict=False):
            parts = self.a.carried(mine), self.b.carried(theirs)
            if parts[0] is None or parts[1] is None:
                continue
            lines = [block(part.span, side) for part, side in zip(parts, self.sides, strict=True) if part]
            if different(*lines) or different(*lines[::-1]):
                return Cause(f"part `{parts[1].called}`", parts[0].span, parts[1].span)
        return None

    def _frames(self, before: Node, after: Node) -> Iterator[Pair]:
        """What an element stands in, up to its body: the place of a part among them."""
        assert self.a is not None and self.b is not None
        for mine, theirs in zip_longest(self.a.frames(before)[::-1], self.b.frames(after)[::-1]):
            places = [
                None if node is None else side.place(node)
                for side, node in ((self.a, mine), (self.b, theirs))
            ]
            if None not in places:
                yield places[0], places[1], None
            yield mine, theirs, None

    def _referred(self, before: Node | None, after: Node | None, kinds: Mapping[str, str]) -> Iterator[Pair]:
        """The mesh, material, joint, … that both refer to; `kinds` by the attribute that does."""
        assert self.a is not None and self.b is not None
        if before is None or after is None:
            return
        for attribute, kind in kinds.items():
            mine, _ = self.a.value(before, attribute)
            theirs, _ = self.b.value(after, attribute)
            if mine and theirs:
                yield self.a.node(kind, mine, -1), self.b.node(kind, theirs, -1), None

    def _attribute(
        self, before: Node | None, after: Node | None, wanted: tuple[str, ...] | None
    ) -> Cause | None:
        """Where the first of the attributes that differs is written on either side."""
        if before is None and after is None:
            return None
        if before is None or after is None:
            return Cause("element", self._span(0, before, None), self._span(1, after, None))
        if before.tag != after.tag:
            return Cause(f"`<{after.tag}>`", self._span(0, before, None), self._span(1, after, None))
        assert self.a is not None and self.b is not None
        names = wanted if wanted is not None else tuple(kind_of(after).attributes)
        for name in names:
            if wanted is None and name in _NO_REASON:
                continue
            text, writer = self.a.value(before, name)
            other, theirs = self.b.value(after, name)
            if not _same(text, other):
                spans = self._span(0, writer, name), self._span(1, theirs, name)
                if writer is None and theirs is after:  # where it could stand: the same line without it
                    spans = self._span(0, before, None), spans[1]
                if theirs is None and writer is before:
                    spans = spans[0], self._span(1, after, None)
                return Cause(f"`{name}`", *spans)
        return None

    def _renamed(self, before: Node, after: Node) -> Cause:
        mine, theirs = self._part(0, before), self._part(1, after)
        if mine is not None and theirs is not None and mine.prefix != theirs.prefix:
            return Cause(f"part `{theirs.called}`", mine.span, theirs.span)
        return Cause("`name`", self._span(0, before, "name"), self._span(1, after, "name"))

    # -- what one of them has ----------------------------------------------------------------------------------

    def _one_sided(self, node: Node | None, side: int) -> Cause | None:
        """The part or base that came or went with the element, else the element's own line."""
        if node is None:
            return None
        part = self._part(side, node)
        if part is None:
            node = self._outermost(node, side)
        if part is not None:
            there = self.parts[1 - side].get(part.called)
            return _cause(f"part `{part.called}`", part.span, None if there is None else there[0], side)
        traced, other = self.sides[side].traced, self.sides[1 - side].traced
        assert traced is not None
        bases = _base(self.sides[0]), _base(self.sides[1])
        owner = traced.watch.life(node).owner
        if other is not None and all(bases) and owner == traced.model.file:
            files = [
                _file(each, None if each.traced is None else each.traced.model.file) for each in self.sides
            ]
            if files[0] != files[1]:
                return Cause("base", bases[0], bases[1])
        return _cause("element", self._span(side, node, None), None, side)

    def _outermost(self, node: Node, side: int) -> Node:
        """The outermost body that came or went with the element, or the element itself."""
        for above in node.iterancestors("body"):
            if (side, name_of(above)) not in self.alone:
                break
            node = above
        return node

    def _part(self, side: int, node: Node) -> Part | None:
        """The outermost part that an element belongs to and that the other side has not got so."""
        traced = self.sides[side].traced
        if traced is None:
            return None
        life = traced.watch.life(node)
        for each in (life, *life.sources):
            for part in reversed(each.parts):
                there = self.parts[1 - side].get(part.called)
                if there is None or there[1] != _file(self.sides[side], part.unit.file):
                    return part
        return None

    # -- settings and keyframes --------------------------------------------------------------------------------

    def _setting(self, change: Change) -> Cause | None:
        if self.a is None or self.b is None:
            return None
        path, name = change.kind.split("/"), change.field
        if name.startswith("flag "):
            path, name = [*path, "flag"], name.removeprefix("flag ")
        mine, theirs = self.a.setting(*path), self.b.setting(*path)
        spans = [
            None if node is None or node.get(name) is None else self._span(side, node, name)
            for side, node in ((0, mine), (1, theirs))
        ]
        return _cause(f"`{name}`", spans[0], spans[1], 0)

    def _entry(self, change: Change) -> Cause | None:
        """The keys that say the number of one joint, actuator or body; else what moves the body with its key."""
        if self.a is None or self.b is None:
            return None
        vector = change.field.removeprefix("key_")
        mine, theirs = (
            said(elements, node, vector, change.entry)
            for elements, node in zip((self.a, self.b), self._nodes(change), strict=True)
        )
        if mine.text != theirs.text:
            return Cause("key", mine.span, theirs.span)
        bodies = _body(mine.holder), _body(theirs.holder)
        if bodies[0] is not None and bodies[1] is not None:
            attached = self._attached(bodies[0], bodies[1])
            if attached is not None:
                return attached
        for before, after, attributes in self._holding(mine.holder, theirs.holder):
            if (cause := self._attribute(before, after, attributes)) is not None:
                return cause
        return None

    def _holding(self, before: Node | None, after: Node | None) -> Iterator[Pair]:
        """The body of a joint, and what that stands in; an actuator by itself."""
        if before is None or after is None:
            return
        yield before, after, ("ref",)
        mine, theirs = _body(before), _body(after)
        if mine is not None and theirs is not None:
            yield mine, theirs, quantity("body_pos").attributes
            yield from self._frames(mine, theirs)

    def _span(self, side: int, node: Node | None, attribute: str | None) -> Span | None:
        traced = self.sides[side].traced
        if traced is None or node is None:
            return None
        if attribute is None:
            return next(
                (reason.span for reason in traced.written(traced.watch.life(node)) if reason.span), None
            )
        return traced.written_at(node, attribute)


def _body(node: Node | None) -> Node | None:
    """The body itself, or the one that a joint belongs to."""
    if node is None or node.tag == "body":
        return node
    return next(node.iterancestors("body"), None)


def _cause(words: str, here: Span | None, there: Span | None, side: int) -> Cause | None:
    """A cause that is told from one side; None where no line is known."""
    if here is None and there is None:
        return None
    return Cause(words, here, there) if side == 0 else Cause(words, there, here)


def _base(side: Side) -> Span | None:
    """Where a recipe names its base."""
    return None if side.plan is None else locate(side.plan.document, ("base",))


def _file(side: Side, file: str | None) -> str:
    """A file as it lies from A or B itself, so that two folders that are laid out alike have the same.

    What was fetched lies in the reference that names it, whatever commit or archive that is.
    """
    operand = side.operand
    path = operand.context.folder / (file or "")
    return operand.fetched(path) or os.path.relpath(path, operand.path.parent)


def _parts(side: Side) -> dict[str, tuple[Span | None, str]]:
    """The parts of a side by what they are called: where they are attached, and the file that they are."""
    if side.traced is None:
        return {}
    lives = side.traced.watch.lives.values()
    found = {part.called: part for life in lives for part in life.parts}
    return {called: (part.span, _file(side, part.unit.file)) for called, part in found.items()}


def _same(a: str | None, b: str | None) -> bool:
    """Whether two texts mean one value."""
    if a is None or b is None:
        return a == b
    ours, theirs = a.split(), b.split()
    return len(ours) == len(theirs) and all(map(_same_word, ours, theirs))


def _same_word(a: str, b: str) -> bool:
    try:
        return a == b or float(a) == float(b)
    except ValueError:
        return False
