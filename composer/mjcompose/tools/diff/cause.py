"""The line that causes a difference."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain, zip_longest
from typing import TypeAlias

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Span
from mjcompose.contrast.changes import SETTINGS, CauseLines, Contrast, FieldChange
from mjcompose.link.linking import Part
from mjcompose.mujoco.arrays import about
from mjcompose.plan.steps import AddElement
from mjcompose.sides.side import Side
from mjcompose.text.node import Mapping as Located, Node as LocatedNode, Sequence, locate, to_python
from mjcompose.tools.diff.elements import ASSETS, INERTIAL, Pair, Pairs, SideElements
from mjcompose.tools.diff.recipe_lines import FilePairs, is_yaml, name, real
from mjcompose.trace.query import name_of, same_value
from mjcompose.trace.trace import Life
from mjcompose.trace.trace_words import removal_reason
from mjcompose.tree.select import kind_of

_NO_REASON = ("name", "class", "childclass")
_PLACING = (
    "pos",
    "quat",
    "euler",
    "axisangle",
    "xyaxes",
    "zaxis",
    "site",
    "body",
    "frame",
    "mate",
    "replicate",
    "joint",
)
"""The keys of a part in a recipe that determine its pose."""
_DEEP = 8


class CauseFinder:
    """Looks up causes in both trees; `found` is the contrast of the two models.

    Each method searches for places that may be the cause, the likeliest first. The first place whose lines differ
    between A and B is the cause.
    """

    def __init__(self, a: Side, b: Side, found: Contrast) -> None:
        sides = {"removed": 0, "added": 1}
        bodies = (each for each in found.changes if each.kind == "body" and each.what in sides)
        self.alone: set[tuple[int, str | None]] = {(sides[each.what], each.name) for each in bodies}
        self.a, self.b = (
            SideElements(side, {kind: n[at] for kind, n in found.elements.items()}) for at, side in enumerate((a, b))
        )
        self.both = self.a, self.b
        self.written = FilePairs(self.a.recipes, self.b.recipes)
        self.pairs = Pairs(self.a, self.b)

    def of(self, change: FieldChange) -> CauseLines | None:
        """Return the cause of a change, or None if no line is known."""
        before, after = self._nodes(change)
        others = chain(self._around(before, after), self._naming(before, 0), self._naming(after, 1))
        found = self._first(self._candidates(change, before, after)) or self._content(change, before, after)
        return found or self._first(others) or self.written.only()

    def _first(self, causes: Iterable[CauseLines], depth: int = 0) -> CauseLines | None:
        settled = (self._settled(cause, depth) for cause in causes)
        return next((cause for cause in settled if cause is not None), None)

    def _candidates(self, change: FieldChange, before: Node | None, after: Node | None) -> Iterator[CauseLines]:
        if change.kind.partition("/")[0] in SETTINGS:
            yield from self._setting(change)
        elif change.what == "changed" and change.kind == "key" and change.entry:
            yield from self._entry(change)
        elif change.what == "added" and after is not None:
            yield from self._one_sided(after, 1)
        elif change.what == "removed" and before is not None:
            yield from self._one_sided(before, 0)
        elif before is not None and after is not None:
            yield from self._swapped(after)
            if change.what == "renamed":
                yield from self._renamed(before, after)
            else:
                yield from self._changed(change, before, after)

    def _nodes(self, change: FieldChange) -> tuple[Node | None, Node | None]:
        first, second = change.index
        return self.a.node(change.kind, change.name_before, first), self.b.node(change.kind, change.name, second)

    def _settled(self, cause: CauseLines, depth: int = 0) -> CauseLines | None:
        """Return the cause with the lines that differ between A and B, or None if all its lines are the same.

        If a line is the same but contains an expression, the cause is where the names in it get other values.
        """
        spans = cause.before, cause.after
        before, after = (self.written.changed(side, span) for side, span in enumerate(spans))
        if before is not None or after is not None:
            before = before or self._opposite(1, after, cause.before)
            return CauseLines(cause.words, before, after or self._opposite(0, before, cause.after))
        if depth > _DEEP:
            return None
        before, after = (None if span is None else span.source for span in spans)
        if before is not None or after is not None:
            row = self._settled(CauseLines(cause.words, before, after), depth + 1)
            if row is not None:
                return row
        names = chain.from_iterable(side.recipes.names_at(span) for side, span in zip(self.both, spans, strict=True))
        return self._first(chain.from_iterable(map(self._of_parameter, dict.fromkeys(names))), depth + 1)

    def _of_parameter(self, parameter: str) -> Iterator[CauseLines]:
        """Yield the lines that can set a parameter, in A and in B."""
        places = [side.recipes.parameter(parameter) for side in self.both]
        for before, after in zip_longest(*places):
            yield CauseLines(f"`{parameter}`", before, after)

    def _opposite(self, side: int, changed: Span | None, known: Span | None) -> Span | None:
        """Return the place to show on the other side of a new or removed line.

        If a recipe sets the value on one side and a file on the other, it is the recipe's line in the same place.
        That way an edit whose selector changed is one cause, not one for each element.
        """
        if changed is None or known is None or is_yaml(known) or not is_yaml(changed):
            return known
        return self.written.twin(side, changed)

    def _changed(self, change: FieldChange, before: Node, after: Node) -> Iterator[CauseLines]:
        wanted = about(change.field).attributes
        for mine, theirs, attributes in self.pairs.candidates(change, before, after, wanted=wanted):
            yield from self._attribute(mine, theirs, attributes)

    def _swapped(self, after: Node) -> Iterator[CauseLines]:
        """Yield the part that names another model, if both sides have a part of that name."""
        part = self._part(1, after)
        there = None if part is None else self.a.parts.get(part.called)
        if part is not None and there is not None:
            yield from _said(self.a.recipes.attachment(there), self.b.recipes.attachment(part), ("model",))
            yield CauseLines(f"part `{part.called}`", there.span, part.span)

    def _content(self, change: FieldChange, before: Node | None, after: Node | None) -> CauseLines | None:
        """Return a file with the same name but other bytes, of the element or of an asset that it refers to."""
        if before is None or after is None:
            return None
        pairs: list[Pair] = [(before, after, None), *self.pairs.referred(before, after, ASSETS)]
        if change.field in INERTIAL:
            for geom, other in zip(self.a.inside(before, "geom"), self.b.inside(after, "geom"), strict=False):
                pairs += self.pairs.referred(geom, other, ASSETS)
        for mine, theirs, _ in pairs:
            files = [None if node is None else node.get("file") for node in (mine, theirs)]
            digests = [each.side.digests.get(str(file)) for each, file in zip(self.both, files, strict=True)]
            if None not in digests and digests[0] != digests[1]:
                return CauseLines(
                    f"`{files[1]}` has other bytes", self.a.span(mine, "file"), self.b.span(theirs, "file")
                )
        return None

    def _attribute(
        self, before: Node | None, after: Node | None, wanted: tuple[str, ...] | None
    ) -> Iterator[CauseLines]:
        """Yield the places where either side writes the differing attributes, and the causes of their values."""
        if before is None and after is None:
            return
        yield from self._carried(before, after, wanted)
        if before is None or after is None:
            yield CauseLines("element", self.a.span(before), self.b.span(after))
            return
        if before.tag != after.tag:
            yield CauseLines(f"`<{after.tag}>`", self.a.span(before), self.b.span(after))
            return
        if wanted is None:
            wanted = tuple(attribute for attribute in kind_of(after).attributes if attribute not in _NO_REASON)
        for attribute in wanted:
            yield from self._written_differently(attribute, before, after)

    def _carried(self, before: Node | None, after: Node | None, wanted: tuple[str, ...] | None) -> Iterator[CauseLines]:
        """Yield the lines that place the parts for which the linker created two frames or bodies."""
        first = None if before is None else self.a.carried(before)
        second = None if after is None else self.b.carried(after)
        if first is not None or second is not None:
            keys = tuple(dict.fromkeys([*(key for key in wanted or () if key in _PLACING), *_PLACING]))
            yield from _said(self.a.recipes.attachment(first), self.b.recipes.attachment(second), keys)

    def _written_differently(self, attribute: str, before: Node, after: Node) -> Iterator[CauseLines]:
        """Yield the lines that write an attribute, and the classes in force, if the values differ."""
        text, writer = self.a.value(before, attribute)
        other, theirs = self.b.value(after, attribute)
        if _is_same(text, other):
            return
        ours = self.a.written(writer, attribute) or self.a.written(before, None)
        others = self.b.written(theirs, attribute) or self.b.written(after, None)
        for mine, yours in _latest_first(ours, others):
            yield CauseLines(f"`{attribute}`", mine or ours[-1], yours or others[-1])
        yield CauseLines("class", self.a.class_in_force(before), self.b.class_in_force(after))

    def _renamed(self, before: Node, after: Node) -> Iterator[CauseLines]:
        mine = self._part(0, before)
        theirs = self._part(1, after)
        if mine is not None and theirs is not None and mine.prefix != theirs.prefix:
            yield CauseLines(f"part `{theirs.called}`", mine.span, theirs.span)
        for first, second in _latest_first(self.a.written(before, "name"), self.b.written(after, "name")):
            yield CauseLines("`name`", first, second)

    def _one_sided(self, node: Node, side: int) -> Iterator[CauseLines]:
        """Yield the part or base that was added or removed with the element, or the element's line or removal."""
        part = self._part(side, node)
        here = self.both[side]
        other = self.both[1 - side]
        if part is None:
            node = self._outermost(node, side)
        else:
            there = other.parts.get(part.called)
            if there is not None:
                both = here.recipes.attachment(part), other.recipes.attachment(there)
                yield from _said(*(both if side == 0 else both[::-1]), ("model",))
            yield _cause(f"part `{part.called}`", part.span, None if there is None else there.span, side=side)
        plans = (each.side.plan for each in self.both)
        bases = [None if plan is None else locate(plan.document, ("base",)) for plan in plans]
        file = here.traced.model.file
        traced = other.side.traced
        is_other = traced is not None and not self._same_file(side, file, traced.model.file)
        if is_other and all(bases) and here.traced.watch.life(node).owner == file:
            yield CauseLines("base", bases[0], bases[1])
        span = here.span(node)
        yield _cause("element", span, None, side=side)
        yield from self._removed(node, 1 - side)
        yield from self._conditions(span)

    def _naming(self, node: Node | None, side: int) -> Iterator[CauseLines]:
        """Yield the lines that name the element on either side: a renamed element counts as another element."""
        if node is None:
            return
        life = self.both[side].life(node)
        for at, each in ((side, node), (1 - side, self.both[1 - side].like(life))):
            for place in reversed(self.both[at].written(each, "name")):
                yield _cause("`name`", place, None, side=at)

    def _removed(self, node: Node, side: int) -> Iterator[CauseLines]:
        """Yield the cause that removed the element on the side that also read it."""
        life = self.both[1 - side].traced.watch.life(node)
        traced = self.both[side].side.traced
        if traced is not None:
            for gone in traced.watch.gone:
                is_same = (gone.tag, gone.attributes) == (life.tag, life.attributes)
                if is_same and isinstance(gone.owner, str) is isinstance(life.owner, str):
                    yield _cause("removed", None, removal_reason(gone).span, side=1 - side)

    def _conditions(self, span: Span | None) -> Iterator[CauseLines]:
        """Yield the `when` of the item around a place."""
        for side in (0, 1):
            for item, when in self.both[side].recipes.conditions():
                if span is not None and self.written.is_within(side, item, span):
                    yield _cause("`when`", when.span, None, side=side)

    def _outermost(self, node: Node, side: int) -> Node:
        """Return the outermost body that was added or removed with the element, or the element itself."""
        for above in node.iterancestors("body"):
            if (side, name_of(above)) not in self.alone:
                break
            node = above
        return node

    def _part(self, side: int, node: Node) -> Part | None:
        """Return the outermost part of an element that the other side does not have with the same file."""
        for part in self.both[side].parts_of(node):
            there = self.both[1 - side].parts.get(part.called)
            if there is None or not self._same_file(side, part.unit.file, there.unit.file):
                return part
        return None

    def _same_file(self, side: int, file: str, there: str) -> bool:
        """Return whether both sides name the same file, or files at the same place."""
        here = self.both[side].side
        other = self.both[1 - side].side
        return real(here, file) == real(other, there) or name(here, file) == name(other, there)

    def _around(self, before: Node | None, after: Node | None) -> Iterator[CauseLines]:
        """Yield the cause for the part, the file or the recipe that an element comes from."""
        ours = self.a.recipes
        yours = self.b.recipes
        for first, second in zip_longest(self.a.parts_of(before), self.b.parts_of(after)):
            mine = ours.attachment(second, yours) if first is None else ours.attachment(first)
            theirs = yours.attachment(first, ours) if second is None else yours.attachment(second)
            yield from _said(mine, theirs, None)
        yield from _said(ours.base(), yours.base(), None)
        lives = self.a.life(before), self.b.life(after)
        yield CauseLines("`to`", _added_to(lives[0]), _added_to(lives[1]))
        compilers = [side.compiler_settings(life) for side, life in zip(self.both, lives, strict=True)]
        for each in dict.fromkeys([*compilers[0], *compilers[1]]):
            yield CauseLines(f"`{each.split()[0]}`", compilers[0].get(each), compilers[1].get(each))

    def _setting(self, change: FieldChange) -> Iterator[CauseLines]:
        path = change.kind.split("/")
        attribute = change.field
        if attribute.startswith("flag "):
            path = [*path, "flag"]
            attribute = attribute.removeprefix("flag ")
        nodes = [(side, side.setting(*path)) for side in self.both]
        places = (
            [] if node is None or node.get(attribute) is None else side.written(node, attribute) for side, node in nodes
        )
        yield from (CauseLines(f"`{attribute}`", before, after) for before, after in _latest_first(*places))

    def _entry(self, change: FieldChange) -> Iterator[CauseLines]:
        """Yield the key's numbers for a joint, actuator or body, or else the cause that moves the body with its key."""
        vector = change.field.removeprefix("key_")
        before, after = self._nodes(change)
        mine, ours = self.a.key_lines(before, vector, change.entry)
        yours, theirs = self.b.key_lines(after, vector, change.entry)
        yield from (CauseLines("key", first, second) for first, second in zip_longest(ours, theirs))
        for pair in self.pairs.holding(mine, yours):
            yield from self._attribute(*pair)


_Spans: TypeAlias = tuple[Span | None, Span | None]


def _is_same(text: str | None, other: str | None) -> bool:
    if text is None or other is None:
        return text == other
    return same_value(text, other)


def _latest_first(mine: list[Span], theirs: list[Span]) -> Iterator[_Spans]:
    """Pair the places of both sides in their order, and yield the last pair first."""
    return reversed(list(zip_longest(mine, theirs)))


def _said(mine: Located | None, theirs: Located | None, keys: tuple[str, ...] | None) -> Iterator[CauseLines]:
    """Yield the lines about a part that differ between two recipes; `keys` limits the comparison."""
    ours, others = ({} if each is None else each.entries for each in (mine, theirs))
    compared = keys if keys is not None else {**ours, **others}
    for key in compared:
        first, second = (each[key][1] if key in each else None for each in (ours, others))
        yield from (CauseLines(f"`{key}`", before, after) for before, after in _unlike(first, second))


def _unlike(mine: LocatedNode | None, theirs: LocatedNode | None) -> Iterator[_Spans]:
    """Yield the places of the innermost pairs of values that differ."""
    if isinstance(mine, Located) and isinstance(theirs, Located):
        for key in {**mine.entries, **theirs.entries}:
            yield from _unlike(*(each.entries[key][1] if key in each.entries else None for each in (mine, theirs)))
    elif isinstance(mine, Sequence) and isinstance(theirs, Sequence):
        for first, second in zip_longest(mine.items, theirs.items):
            yield from _unlike(first, second)
    elif mine is None or theirs is None or type(mine) is not type(theirs) or to_python(mine) != to_python(theirs):
        yield None if mine is None else mine.span, None if theirs is None else theirs.span


def _added_to(life: Life | None) -> Span | None:
    """Return the place where the recipe names the holder of an element that it adds."""
    done = None if life is None or life.made_by is None else life.made_by.done
    return done.to_span if isinstance(done, AddElement) else None


def _cause(words: str, here: Span | None, there: Span | None, side: int) -> CauseLines:
    return CauseLines(words, here, there) if side == 0 else CauseLines(words, there, here)
