"""The line that causes a difference."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import chain, zip_longest
from typing import TypeAlias

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Span
from mjcompose.build.plan.steps import AddElement
from mjcompose.link.linking import Part
from mjcompose.link.unit_keys import VECTORS
from mjcompose.mujoco.arrays import about
from mjcompose.text.node import Mapping as Located
from mjcompose.text.node import Node as LocatedNode
from mjcompose.text.node import Sequence, locate, to_python
from mjcompose.tools.diff.changes import ASSETS, INERTIAL, SETTINGS, Cause, Change, Contrast, Elements, Pair, Pairs
from mjcompose.tools.diff.recipe_lines import Recipes, Written, is_yaml, name, real
from mjcompose.tools.diff.sides import Side
from mjcompose.tools.explain.query import name_of, same_value
from mjcompose.tools.explain.trace import Life
from mjcompose.tree.classes import class_in_force
from mjcompose.tree.select import kind_of


class Places:
    """Looks up elements in the traces of both sides; `side` is 0 for A and 1 for B."""

    def __init__(self, a: Side, b: Side, recipes: tuple[Recipes, Recipes]) -> None:
        self.sides = a, b
        self.recipes = recipes
        self.parts = _parts(a), _parts(b)

    def span(self, side: int, node: Node | None, attribute: str | None) -> Span | None:
        traced = self.sides[side].traced
        if traced is None or node is None:
            return None
        if attribute is None:
            return next((reason.span for reason in traced.written(traced.watch.life(node)) if reason.span), None)
        return traced.written_at(node, attribute)

    def written(self, side: int, node: Node | None, attribute: str | None) -> list[Span]:
        """Return where an attribute was first written, and where it was changed since."""
        traced = self.sides[side].traced
        if attribute is None:
            span = self.span(side, node, None)
            return [] if span is None else [span]
        return [] if traced is None or node is None else traced.history(node, attribute)

    def class_in_force(self, side: int, node: Node) -> Span | None:
        """Return where the class in force for an element is written."""
        force = class_in_force(node)
        return None if force.attribute is None else self.span(side, force.writer, force.attribute)

    def life(self, side: int, node: Node | None) -> Life | None:
        traced = self.sides[side].traced
        return None if traced is None or node is None else traced.watch.life(node)

    def parts_of(self, side: int, node: Node | None) -> Iterator[Part]:
        """Yield the parts that an element belongs to, the outermost first."""
        life = self.life(side, node)
        for each in () if life is None else (life, *life.sources):
            yield from reversed(each.parts)

    def part(self, side: int, node: Node) -> Part | None:
        """Return the outermost part of an element that the other side does not have with the same file."""
        for part in self.parts_of(side, node):
            there = self.parts[1 - side].get(part.called)
            if there is None or not self.same_file(side, part.unit.file, there.unit.file):
                return part
        return None

    def same_file(self, side: int, file: str, there: str) -> bool:
        """Return whether both sides name the same file, or files at the same place."""
        here, other = self.sides[side], self.sides[1 - side]
        return real(here, file) == real(other, there) or name(here, file) == name(other, there)

    def compiler_settings(self, side: int, life: Life | None) -> dict[str, Span]:
        """Return where the file of an element, or the recipe, writes the compiler settings that apply to it."""
        traced = self.sides[side].traced
        if traced is None or life is None:
            return {}
        found: dict[str, Span] = {}
        for source in (life, *life.sources):
            for each in traced.watch.lives.values():
                if each.tag == "compiler" and each.root is source.root and isinstance(each.owner, str):
                    found |= {key: each.span(traced.model.origins, key) for key in each.attributes}
        here = self.sides[side]
        found |= {f"{key} of {name(here, span.file)}": span for key, span in self.recipes[side].settings}
        return found

    def of_the_same_line(self, node: Node, side: int) -> Node | None:
        """Return the other side's element that was read from the same line of a model, or None if there is none."""
        mine, there = self.life(side, node), self.sides[1 - side].traced
        if mine is None or there is None:
            return None
        for life in there.watch.lives.values():
            is_same = (life.tag, life.line, life.attributes) == (mine.tag, mine.line, mine.attributes)
            if is_same and life.made_by is None and life.gone is None:
                return life.node
        return None


def _parts(side: Side) -> dict[str, Part]:
    if side.traced is None:
        return {}
    return {part.called: part for life in side.traced.watch.lives.values() for part in life.parts}


def key_lines(elements: Elements, key: Node | None, vector: str, entry: str) -> tuple[Node | None, tuple[Span, ...]]:
    """Return the element of a key's numbers, and where they are written, the numbers themselves first."""
    traced = elements.traced
    if key is None or vector not in VECTORS:
        return None, ()
    found = [each for each in traced.key_rows(key, vector) if name_of(each[0]) == entry]
    if not found:
        span = traced.written_at(key, vector)
        return None, () if span is None else (span,)
    rows = [row for _, row in found]
    reasons = [*(row.reason for row in rows), *(reason for row in rows for reason in row.on_the_way)]
    return found[0][0], tuple(dict.fromkeys(reason.span for reason in reasons if reason.span))


_NO_REASON = ("name", "class", "childclass")
_PLACING = (
    "pos", "quat", "euler", "axisangle", "xyaxes", "zaxis", "site", "body", "frame", "mate", "replicate", "joint",
)  # fmt: skip
"""The keys of a part in a recipe that determine its pose."""
_DEEP = 8


class Causes:
    """Looks up causes in both trees; `found` is the contrast of the two models.

    Each method searches for places that may be the cause, the likeliest first. The first place whose lines differ
    between A and B is the cause.
    """

    def __init__(self, a: Side, b: Side, found: Contrast) -> None:
        self.alone: set[tuple[int, str | None]] = {
            (("removed", "added").index(each.what), each.name)
            for each in found.changes
            if each.kind == "body" and each.what in ("removed", "added")
        }
        self.sides = a, b
        self.a, self.b = (
            None if side.traced is None else Elements(side.traced, {kind: n[at] for kind, n in found.elements.items()})
            for at, side in enumerate((a, b))
        )
        self.recipes = Recipes(a), Recipes(b)
        self.written = Written(*self.recipes)
        self.places = Places(a, b, self.recipes)

    @cached_property
    def pairs(self) -> Pairs:
        assert self.a is not None and self.b is not None
        return Pairs(self.a, self.b)

    def of(self, change: Change) -> Cause | None:
        """Return the cause of a change, or None if no line is known."""
        before, after = self._nodes(change)
        others = chain(self._around(before, after), self._naming(before, 0), self._naming(after, 1))
        found = self._first(self._candidates(change, before, after)) or self._content(change, before, after)
        return found or self._first(others) or self.written.only()

    def _first(self, causes: Iterable[Cause]) -> Cause | None:
        settled = (self._settled(cause) for cause in causes)
        return next((cause for cause in settled if cause is not None), None)

    def _candidates(self, change: Change, before: Node | None, after: Node | None) -> Iterator[Cause]:
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

    def _nodes(self, change: Change) -> tuple[Node | None, Node | None]:
        first, second = change.index
        return (
            None if self.a is None else self.a.node(change.kind, change.name_before, first),
            None if self.b is None else self.b.node(change.kind, change.name, second),
        )

    def _settled(self, cause: Cause, depth: int = 0) -> Cause | None:
        """Return the cause with the lines that differ between A and B, or None if all its lines are the same.

        If a line is the same but contains an expression, the cause is where the names in it get other values.
        """
        spans = cause.before, cause.after
        before, after = (self.written.changed(side, span) for side, span in enumerate(spans))
        if before is not None or after is not None:
            before = before or self._opposite(1, after, cause.before)
            return Cause(cause.words, before, after or self._opposite(0, before, cause.after))
        if depth > _DEEP:
            return None
        names = [each for side in (0, 1) for each in self.recipes[side].names_at(spans[side])]
        for each in dict.fromkeys(names):
            places = [list(recipes.parameter(each)) for recipes in self.recipes]
            for before, after in zip_longest(*places):
                if (found := self._settled(Cause(f"`{each}`", before, after), depth + 1)) is not None:
                    return found
        return None

    def _opposite(self, side: int, changed: Span | None, known: Span | None) -> Span | None:
        """Return the place to show on the other side of a line that is new or gone.

        If a recipe sets the value on one side and a file on the other, it is the recipe's line in the same place.
        That way an edit whose selector changed is one cause, not one for each element.
        """
        if changed is None or known is None or is_yaml(known) or not is_yaml(changed):
            return known
        return self.written.twin(side, changed)

    def _changed(self, change: Change, before: Node, after: Node) -> Iterator[Cause]:
        wanted = about(change.field).attributes
        for mine, theirs, attributes in self.pairs.candidates(change, before, after, wanted=wanted):
            yield from self._attribute(mine, theirs, attributes)

    def _swapped(self, after: Node) -> Iterator[Cause]:
        """Yield the part that names another model, if both sides have a part of that name."""
        part = self.places.part(1, after)
        there = None if part is None else self.places.parts[0].get(part.called)
        if part is not None and there is not None:
            yield from self._said(self._known(0, there), self._known(1, part), ("model",))
            yield Cause(f"part `{part.called}`", there.span, part.span)

    def _content(self, change: Change, before: Node | None, after: Node | None) -> Cause | None:
        """Return a file with the same name but other bytes, of the element or of an asset that it refers to."""
        if before is None or after is None:
            return None
        pairs: list[Pair] = [(before, after, None), *self.pairs.referred(before, after, ASSETS)]
        if change.field in INERTIAL:
            assert self.a is not None and self.b is not None
            for geom, other in zip(self.a.inside(before, "geom"), self.b.inside(after, "geom"), strict=False):
                pairs += self.pairs.referred(geom, other, ASSETS)
        for mine, theirs, _ in pairs:
            files = [None if node is None else node.get("file") for node in (mine, theirs)]
            digests = [side.digests.get(str(file)) for side, file in zip(self.sides, files, strict=True)]
            if None not in digests and digests[0] != digests[1]:
                words = f"`{files[1]}` has other bytes"
                return Cause(words, self.places.span(0, mine, "file"), self.places.span(1, theirs, "file"))
        return None

    def _attribute(self, before: Node | None, after: Node | None, wanted: tuple[str, ...] | None) -> Iterator[Cause]:
        """Yield where the differing attributes are written on either side, and the causes of their values."""
        if before is None and after is None:
            return
        assert self.a is not None and self.b is not None
        # The parts for which the linker created two frames or bodies.
        first = None if before is None else self.a.carried(before)
        second = None if after is None else self.b.carried(after)
        if first is not None or second is not None:
            keys = tuple(dict.fromkeys([*(each for each in wanted or () if each in _PLACING), *_PLACING]))
            yield from self._said(self._known(0, first), self._known(1, second), keys)
        if before is None or after is None:
            yield Cause("element", self.places.span(0, before, None), self.places.span(1, after, None))
            return
        if before.tag != after.tag:
            yield Cause(f"`<{after.tag}>`", self.places.span(0, before, None), self.places.span(1, after, None))
            return
        names = wanted if wanted is not None else tuple(kind_of(after).attributes)
        for attribute in names:
            if wanted is None and attribute in _NO_REASON:
                continue
            text, writer = self.a.value(before, attribute)
            other, theirs = self.b.value(after, attribute)
            if text == other if text is None or other is None else same_value(text, other):
                continue
            places = [
                self.places.written(0, writer, attribute) or self.places.written(0, before, None),
                self.places.written(1, theirs, attribute) or self.places.written(1, after, None),
            ]
            for mine, yours in reversed(list(zip_longest(*places))):
                yield Cause(f"`{attribute}`", mine or places[0][-1], yours or places[1][-1])
            yield Cause("class", self.places.class_in_force(0, before), self.places.class_in_force(1, after))

    def _renamed(self, before: Node, after: Node) -> Iterator[Cause]:
        mine, theirs = self.places.part(0, before), self.places.part(1, after)
        if mine is not None and theirs is not None and mine.prefix != theirs.prefix:
            yield Cause(f"part `{theirs.called}`", mine.span, theirs.span)
        places = self.places.written(0, before, "name"), self.places.written(1, after, "name")
        for first, second in reversed(list(zip_longest(*places))):
            yield Cause("`name`", first, second)

    def _one_sided(self, node: Node, side: int) -> Iterator[Cause]:
        """Yield the part or base that came or went with the element, or the element's own line, or its removal."""
        part = self.places.part(side, node)
        if part is None:
            node = self._outermost(node, side)
        else:
            there = self.places.parts[1 - side].get(part.called)
            if there is not None:
                both = self._known(side, part), self._known(1 - side, there)
                yield from self._said(*(both if side == 0 else both[::-1]), ("model",))
            yield _cause(f"part `{part.called}`", part.span, None if there is None else there.span, side=side)
        traced, other = self.sides[side].traced, self.sides[1 - side].traced
        assert traced is not None
        bases = [None if each.plan is None else locate(each.plan.document, ("base",)) for each in self.sides]
        owner = traced.watch.life(node).owner
        replaced = other is not None and not self.places.same_file(side, traced.model.file, other.model.file)
        if replaced and all(bases) and owner == traced.model.file:
            yield Cause("base", bases[0], bases[1])
        span = self.places.span(side, node, None)
        yield _cause("element", span, None, side=side)
        yield from self._removed(node, 1 - side)
        yield from self._conditions(span)

    def _naming(self, node: Node | None, side: int) -> Iterator[Cause]:
        """Yield the lines that name the element on either side: a renamed element counts as another element."""
        if node is None:
            return
        for at, each in ((side, node), (1 - side, self.places.of_the_same_line(node, side))):
            for place in reversed(self.places.written(at, each, "name")):
                yield _cause("`name`", place, None, side=at)

    def _removed(self, node: Node, side: int) -> Iterator[Cause]:
        """Yield the cause that removed the element on the side that also read it."""
        here, traced = self.sides[1 - side].traced, self.sides[side].traced
        if here is None or traced is None:
            return
        life = here.watch.life(node)
        for gone in traced.watch.gone:
            is_same = (gone.tag, gone.attributes) == (life.tag, life.attributes)
            if is_same and isinstance(gone.owner, str) is isinstance(life.owner, str):
                yield _cause("removed", None, traced.causes.gone(gone).span, side=1 - side)

    def _conditions(self, span: Span | None) -> Iterator[Cause]:
        """Yield the `when` of the item around a place."""
        for side in (0, 1):
            for item, when in self.recipes[side].conditions():
                if span is not None and self.written.is_within(side, item, span):
                    yield _cause("`when`", when.span, None, side=side)

    def _outermost(self, node: Node, side: int) -> Node:
        """Return the outermost body that came or went with the element, or the element itself."""
        for above in node.iterancestors("body"):
            if (side, name_of(above)) not in self.alone:
                break
            node = above
        return node

    def _known(self, side: int, part: Part | None) -> Located | None:
        return None if part is None else self.recipes[side].attachment(part)

    def _said(self, mine: Located | None, theirs: Located | None, keys: tuple[str, ...] | None) -> Iterator[Cause]:
        """Yield the lines about a part that differ between two recipes; `keys` limits the comparison."""
        ours, others = ({} if each is None else each.entries for each in (mine, theirs))
        for key in keys if keys is not None else {**ours, **others}:
            first, second = (each[key][1] if key in each else None for each in (ours, others))
            for before, after in _unlike(first, second):
                first_span, second_span = (None if node is None else node.span for node in (before, after))
                yield Cause(f"`{key}`", first_span, second_span)

    def _around(self, before: Node | None, after: Node | None) -> Iterator[Cause]:
        """Yield the cause for the part, the file or the recipe that an element comes from."""
        for first, second in zip_longest(self.places.parts_of(0, before), self.places.parts_of(1, after)):
            mine, theirs = self._known(0, first), self._known(1, second)
            if first is None and theirs is not None and second is not None:
                mine = self.recipes[0].same(self.recipes[1], second)
            if second is None and mine is not None and first is not None:
                theirs = self.recipes[1].same(self.recipes[0], first)
            yield from self._said(mine, theirs, None)
        yield from self._said(self.recipes[0].base(), self.recipes[1].base(), None)
        lives = self.places.life(0, before), self.places.life(1, after)
        yield Cause("`to`", _added_to(lives[0]), _added_to(lives[1]))
        compilers = [self.places.compiler_settings(side, life) for side, life in enumerate(lives)]
        for each in dict.fromkeys([*compilers[0], *compilers[1]]):
            yield Cause(f"`{each.split()[0]}`", compilers[0].get(each), compilers[1].get(each))

    def _setting(self, change: Change) -> Iterator[Cause]:
        if self.a is None or self.b is None:
            return
        path, attribute = change.kind.split("/"), change.field
        if attribute.startswith("flag "):
            path, attribute = [*path, "flag"], attribute.removeprefix("flag ")
        places = [
            [] if node is None or node.get(attribute) is None else self.places.written(side, node, attribute)
            for side, node in ((0, self.a.setting(*path)), (1, self.b.setting(*path)))
        ]
        for before, after in reversed(list(zip_longest(*places))):
            yield Cause(f"`{attribute}`", before, after)

    def _entry(self, change: Change) -> Iterator[Cause]:
        """Yield the key's numbers for a joint, actuator or body; else the cause that moves the body with its key."""
        if self.a is None or self.b is None:
            return
        vector = change.field.removeprefix("key_")
        (mine, ours), (yours, theirs) = (
            key_lines(elements, node, vector, entry=change.entry)
            for elements, node in zip((self.a, self.b), self._nodes(change), strict=True)
        )
        for before, after in zip_longest(ours, theirs):
            yield Cause("key", before, after)
        for pair in self.pairs.holding(mine, yours):
            yield from self._attribute(*pair)


_Both: TypeAlias = "tuple[LocatedNode | None, LocatedNode | None]"


def _unlike(mine: LocatedNode | None, theirs: LocatedNode | None) -> Iterator[_Both]:
    """Yield the innermost pairs of values that differ."""
    if isinstance(mine, Located) and isinstance(theirs, Located):
        for key in {**mine.entries, **theirs.entries}:
            yield from _unlike(*(each.entries[key][1] if key in each.entries else None for each in (mine, theirs)))
    elif isinstance(mine, Sequence) and isinstance(theirs, Sequence):
        for first, second in zip_longest(mine.items, theirs.items):
            yield from _unlike(first, second)
    elif mine is None or theirs is None or type(mine) is not type(theirs) or to_python(mine) != to_python(theirs):
        yield mine, theirs


def _added_to(life: Life | None) -> Span | None:
    """Return where the recipe names the holder of an element that it adds."""
    done = None if life is None or life.made_by is None else life.made_by.done
    return done.to_span if isinstance(done, AddElement) else None


def _cause(words: str, here: Span | None, there: Span | None, side: int) -> Cause:
    return Cause(words, here, there) if side == 0 else Cause(words, there, here)
