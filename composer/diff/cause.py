"""Which line makes a difference: the attribute that is not the same in both trees, and where it is written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain, zip_longest
from typing import TYPE_CHECKING, TypeAlias

from composer.compiled.quantities import quantity
from composer.diagnostics.span import Span
from composer.diff.change import SETTINGS, Cause, Change, Contrast
from composer.diff.elements import Elements
from composer.diff.excerpt import is_yaml
from composer.diff.recipes import Recipes
from composer.diff.said import said
from composer.diff.side import Side
from composer.diff.written import Written, name, real
from composer.document.node import Mapping as Located
from composer.document.node import Node as LocatedNode
from composer.document.node import Sequence, locate, to_python
from composer.explain.query import name_of
from composer.explain.trace import Life
from composer.plan.steps.add_element import AddElement
from composer.tree.effective import class_in_force
from composer.tree.kinds import kind_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.link.part import Part

_INERTIAL = frozenset({"body_mass", "body_inertia", "body_ipos", "body_iquat", "body_subtreemass"})
Pair: TypeAlias = "tuple[Node | None, Node | None, tuple[str, ...] | None]"
"""An element of A, the one of B that it is there, and the attributes in question; None for any."""

_NO_REASON = ("name", "class", "childclass")
_ASSETS = {"mesh": "mesh", "material": "material", "hfield": "hfield", "texture": "texture"}
_TARGETS = {"joint": "joint", "jointinparent": "joint", "tendon": "tendon"}
_PATH = {"site": "site", "geom": "geom", "sidesite": "site", "joint": "joint"}
_PLACING = (
    "pos", "quat", "euler", "axisangle", "xyaxes", "zaxis", "site", "body", "frame", "mate", "replicate", "joint",
)  # fmt: skip
"""What a recipe says of a part that decides where it is."""
_POSE = quantity("body_pos").attributes
_DEEP = 8


class Causes:
    """Looks things up in both trees, which `found` is the contrast of.

    Each question is answered by a search: places that may be the reason, the likeliest first. The first one whose
    lines are not the same in A and B is the reason.
    """

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
        self.recipes = Recipes(a), Recipes(b)
        self.written = Written(*self.recipes)

    def of(self, change: Change) -> Cause | None:
        """The cause of a change; None where no line is known."""
        before, after = self._nodes(change)
        for cause in self._candidates(change, before, after):
            if (found := self._settled(cause)) is not None:
                return found
        if before is not None and after is not None:
            content = self._content(change, before, after)
            if content is not None:
                return content
        for cause in chain(self._around(before, after), self._naming(before, 0), self._naming(after, 1)):
            if (found := self._settled(cause)) is not None:
                return found
        return self.written.only()

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

    # -- whether a line is a reason ----------------------------------------------------------------------------

    def _settled(self, cause: Cause, depth: int = 0) -> Cause | None:
        """The cause by the line that is not the same in A and B; None where all its lines are.

        A line that is the same may have an expression in it: then the reason is what gives its names other values.
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
        """The place to show on the other side of a line that is new or gone.

        Where a recipe decides on one side and a file on the other, it is the recipe's line in the same place: an edit
        that selects other elements now is one reason, not one for each of them.
        """
        if changed is None or known is None or is_yaml(known) or not is_yaml(changed):
            return known
        return self.written.twin(side, changed)

    # -- what both have ----------------------------------------------------------------------------------------

    def _changed(self, change: Change, before: Node, after: Node) -> Iterator[Cause]:
        wanted = quantity(change.field).attributes
        for mine, theirs, attributes in self._reasons(change, before, after, wanted):
            yield from self._attribute(mine, theirs, attributes)

    def _swapped(self, after: Node) -> Iterator[Cause]:
        """The part of another model, where both sides have a part of that name."""
        part = self._part(1, after)
        there = None if part is None else self.parts[0].get(part.called)
        if part is not None and there is not None:
            yield from self._said(self._known(0, there), self._known(1, part), ("model",))
            yield Cause(f"part `{part.called}`", there.span, part.span)

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
        if "pos" in wanted or change.field.endswith(("_bodyid", "_parentid")):
            yield from self._frames(before, after, wanted or _POSE)
        yield before, after, tuple(_ASSETS)
        yield from self._referred(before, after, _ASSETS)
        if change.kind == "actuator":
            yield before, after, tuple(_TARGETS)
            for mine, theirs, _ in self._referred(before, after, _TARGETS):
                yield mine, theirs, ("range", "ref", "type", "axis")
        yield before, after, None
        if change.kind == "tendon":
            for mine, theirs in zip_longest(before.iterchildren("*"), after.iterchildren("*")):
                yield mine, theirs, None
            for mine, theirs in zip(before.iterchildren("*"), after.iterchildren("*"), strict=False):
                for first, second, _ in self._referred(mine, theirs, _PATH):
                    yield first, second, None
                    yield from self._above(first, second)

    def _frames(self, before: Node, after: Node, wanted: tuple[str, ...]) -> Iterator[Pair]:
        """What an element stands in, up to its body: the place of a part among them."""
        assert self.a is not None and self.b is not None
        for mine, theirs in zip_longest(self.a.frames(before)[::-1], self.b.frames(after)[::-1]):
            yield mine, theirs, wanted
            places = [
                None if node is None else side.place(node)
                for side, node in ((self.a, mine), (self.b, theirs))
            ]
            if None not in places:
                yield places[0], places[1], wanted

    def _above(self, before: Node | None, after: Node | None) -> Iterator[Pair]:
        """All that an element stands in, up to the world."""
        while before is not None and after is not None:
            yield from self._frames(before, after, _POSE)
            before, after = (next(each.iterancestors("body"), None) for each in (before, after))
            if before is not None and after is not None:
                yield before, after, _POSE

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
    ) -> Iterator[Cause]:
        """Where the attributes that differ are written on either side, and what made them what they are."""
        if before is None and after is None:
            return
        first, second = self._placed(before, after)
        if first is not None or second is not None:
            keys = tuple(dict.fromkeys([*(each for each in wanted or () if each in _PLACING), *_PLACING]))
            yield from self._said(self._known(0, first), self._known(1, second), keys)
        if before is None or after is None:
            yield Cause("element", self._span(0, before, None), self._span(1, after, None))
            return
        if before.tag != after.tag:
            yield Cause(f"`<{after.tag}>`", self._span(0, before, None), self._span(1, after, None))
            return
        assert self.a is not None and self.b is not None
        names = wanted if wanted is not None else tuple(kind_of(after).attributes)
        for attribute in names:
            if wanted is None and attribute in _NO_REASON:
                continue
            text, writer = self.a.value(before, attribute)
            other, theirs = self.b.value(after, attribute)
            if _same(text, other):
                continue
            places = [
                self._places(0, writer, attribute) or self._places(0, before, None),
                self._places(1, theirs, attribute) or self._places(1, after, None),
            ]
            for mine, yours in reversed(list(zip_longest(*places))):
                yield Cause(f"`{attribute}`", mine or places[0][-1], yours or places[1][-1])
            yield Cause("class", self._class(0, before), self._class(1, after))

    def _class(self, side: int, node: Node) -> Span | None:
        """Where it is written which class is in force for an element."""
        force = class_in_force(node)
        return None if force.attribute is None else self._span(side, force.writer, force.attribute)

    def _placed(self, before: Node | None, after: Node | None) -> tuple[Part | None, Part | None]:
        """The parts for whose sake the linker made two frames or bodies."""
        assert self.a is not None and self.b is not None
        return (
            None if before is None else self.a.carried(before),
            None if after is None else self.b.carried(after),
        )

    def _places(self, side: int, node: Node | None, attribute: str | None) -> list[Span]:
        """Where an attribute was written first, and where it was changed since."""
        traced = self.sides[side].traced
        if traced is None or node is None:
            return []
        if attribute is None:
            span = self._span(side, node, None)
            return [] if span is None else [span]
        return traced.history(node, attribute)

    def _renamed(self, before: Node, after: Node) -> Iterator[Cause]:
        mine, theirs = self._part(0, before), self._part(1, after)
        if mine is not None and theirs is not None and mine.prefix != theirs.prefix:
            yield Cause(f"part `{theirs.called}`", mine.span, theirs.span)
        places = self._places(0, before, "name"), self._places(1, after, "name")
        for first, second in reversed(list(zip_longest(*places))):
            yield Cause("`name`", first, second)

    # -- what one of them has ----------------------------------------------------------------------------------

    def _one_sided(self, node: Node, side: int) -> Iterator[Cause]:
        """The part or base that came or went with the element, else the element's own line, else what removes it."""
        part = self._part(side, node)
        if part is None:
            node = self._outermost(node, side)
        else:
            there = self.parts[1 - side].get(part.called)
            if there is not None:
                both = self._known(side, part), self._known(1 - side, there)
                yield from self._said(*(both if side == 0 else both[::-1]), ("model",))
            yield _cause(f"part `{part.called}`", part.span, None if there is None else there.span, side)
        traced, other = self.sides[side].traced, self.sides[1 - side].traced
        assert traced is not None
        bases = _base(self.sides[0]), _base(self.sides[1])
        owner = traced.watch.life(node).owner
        replaced = other is not None and not self._same_file(side, traced.model.file, other.model.file)
        if replaced and all(bases) and owner == traced.model.file:
            yield Cause("base", bases[0], bases[1])
        span = self._span(side, node, None)
        yield _cause("element", span, None, side)
        yield from self._removed(node, 1 - side)
        yield from self._conditions(span)

    def _naming(self, node: Node | None, side: int) -> Iterator[Cause]:
        """What names the element, on this side or the other: by another name it is taken for another element."""
        if node is None:
            return
        for at, each in ((side, node), (1 - side, self._of_the_same_line(node, side))):
            for place in reversed(self._places(at, each, "name")):
                yield _cause("`name`", place, None, at)

    def _of_the_same_line(self, node: Node, side: int) -> Node | None:
        """An element of the other side that was read from the same line of a model; None where nobody wrote it."""
        here, there = self.sides[side].traced, self.sides[1 - side].traced
        if here is None or there is None:
            return None
        mine = here.watch.life(node)
        return next(
            (
                life.node
                for life in there.watch.lives.values()
                if (life.tag, life.line, life.attributes) == (mine.tag, mine.line, mine.attributes)
                and life.made_by is None
                and life.gone is None
            ),
            None,
        )

    def _removed(self, node: Node, side: int) -> Iterator[Cause]:
        """What took the element away on a side that read it too."""
        here, traced = self.sides[1 - side].traced, self.sides[side].traced
        if here is None or traced is None:
            return
        life = here.watch.life(node)
        for gone in traced.watch.gone:
            if (
                gone.tag == life.tag
                and gone.attributes == life.attributes
                and isinstance(gone.owner, str) is isinstance(life.owner, str)
            ):
                yield _cause("removed", None, traced.causes.gone(gone).span, 1 - side)

    def _conditions(self, span: Span | None) -> Iterator[Cause]:
        """The `when` of the item that a place is in."""
        for side in (0, 1):
            for item, when in self.recipes[side].conditions():
                if span is not None and self.written.is_within(side, item, span):
                    yield _cause("`when`", when.span, None, side)

    def _outermost(self, node: Node, side: int) -> Node:
        """The outermost body that came or went with the element, or the element itself."""
        for above in node.iterancestors("body"):
            if (side, name_of(above)) not in self.alone:
                break
            node = above
        return node

    def _part(self, side: int, node: Node) -> Part | None:
        """The outermost part that an element belongs to and that the other side has not got so."""
        for part in self._parts_of(side, node):
            there = self.parts[1 - side].get(part.called)
            if there is None or not self._same_file(side, part.unit.file, there.unit.file):
                return part
        return None

    def _same_file(self, side: int, file: str, there: str) -> bool:
        """Whether both sides mean the same file, or one that lies at the same place."""
        here, other = self.sides[side], self.sides[1 - side]
        return real(here, file) == real(other, there) or name(here, file) == name(other, there)

    def _parts_of(self, side: int, node: Node | None) -> Iterator[Part]:
        """The parts that an element belongs to, the outermost first."""
        traced = self.sides[side].traced
        if traced is None or node is None:
            return
        life = traced.watch.life(node)
        for each in (life, *life.sources):
            yield from reversed(each.parts)

    # -- what is said of a part or a file as a whole -----------------------------------------------------------

    def _known(self, side: int, part: Part | None) -> Located | None:
        return None if part is None else self.recipes[side].attachment(part)

    def _said(
        self, mine: Located | None, theirs: Located | None, keys: tuple[str, ...] | None
    ) -> Iterator[Cause]:
        """What two recipes say of a part and do not say alike; `keys` are those in question, None for any."""
        ours, others = ({} if each is None else each.entries for each in (mine, theirs))
        for key in keys if keys is not None else {**ours, **others}:
            first, second = (each[key][1] if key in each else None for each in (ours, others))
            for before, after in _unlike(first, second):
                first_span, second_span = (None if node is None else node.span for node in (before, after))
                yield Cause(f"`{key}`", first_span, second_span)

    def _around(self, before: Node | None, after: Node | None) -> Iterator[Cause]:
        """What is said of the part, the file or the recipe that an element is from."""
        for first, second in zip_longest(self._parts_of(0, before), self._parts_of(1, after)):
            mine, theirs = self._known(0, first), self._known(1, second)
            if first is None and theirs is not None and second is not None:
                mine = self.recipes[0].same(self.recipes[1], second)
            if second is None and mine is not None and first is not None:
                theirs = self.recipes[1].same(self.recipes[0], first)
            yield from self._said(mine, theirs, None)
        yield from self._said(self.recipes[0].base(), self.recipes[1].base(), None)
        lives = self._life(0, before), self._life(1, after)
        yield Cause("`to`", _added_to(lives[0]), _added_to(lives[1]))
        compilers = [self._compiler(side, life) for side, life in enumerate(lives)]
        for each in dict.fromkeys([*compilers[0], *compilers[1]]):
            yield Cause(f"`{each.split()[0]}`", compilers[0].get(each), compilers[1].get(each))

    def _life(self, side: int, node: Node | None) -> Life | None:
        traced = self.sides[side].traced
        return None if traced is None or node is None else traced.watch.life(node)

    def _compiler(self, side: int, life: Life | None) -> dict[str, Span]:
        """Where the file of an element, or the recipe, says how it is to be read."""
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

    # -- settings and keyframes --------------------------------------------------------------------------------

    def _setting(self, change: Change) -> Iterator[Cause]:
        if self.a is None or self.b is None:
            return
        path, attribute = change.kind.split("/"), change.field
        if attribute.startswith("flag "):
            path, attribute = [*path, "flag"], attribute.removeprefix("flag ")
        places = [
            [] if node is None or node.get(attribute) is None else self._places(side, node, attribute)
            for side, node in ((0, self.a.setting(*path)), (1, self.b.setting(*path)))
        ]
        for before, after in reversed(list(zip_longest(*places))):
            yield Cause(f"`{attribute}`", before, after)

    def _entry(self, change: Change) -> Iterator[Cause]:
        """The numbers of the keys that say it of one joint, actuator or body; else what moves the body with its key."""
        if self.a is None or self.b is None:
            return
        vector = change.field.removeprefix("key_")
        mine, theirs = (
            said(elements, node, vector, change.entry)
            for elements, node in zip((self.a, self.b), self._nodes(change), strict=True)
        )
        for before, after in zip_longest(mine.spans, theirs.spans):
            yield Cause("key", before, after)
        for pair in self._holding(mine.holder, theirs.holder):
            yield from self._attribute(*pair)

    def _holding(self, before: Node | None, after: Node | None) -> Iterator[Pair]:
        """The body of a joint, and all that stands in; an actuator by itself."""
        if before is None or after is None:
            return
        yield before, after, ("ref",)
        mine, theirs = _body(before), _body(after)
        if mine is not None and theirs is not None:
            yield mine, theirs, _POSE
            yield from self._above(mine, theirs)

    def _span(self, side: int, node: Node | None, attribute: str | None) -> Span | None:
        traced = self.sides[side].traced
        if traced is None or node is None:
            return None
        if attribute is None:
            return next(
                (reason.span for reason in traced.written(traced.watch.life(node)) if reason.span), None
            )
        return traced.written_at(node, attribute)


_Both: TypeAlias = "tuple[LocatedNode | None, LocatedNode | None]"


def _unlike(mine: LocatedNode | None, theirs: LocatedNode | None) -> Iterator[_Both]:
    """The innermost pairs of values that are not the same."""
    if isinstance(mine, Located) and isinstance(theirs, Located):
        for key in {**mine.entries, **theirs.entries}:
            yield from _unlike(
                *(each.entries[key][1] if key in each.entries else None for each in (mine, theirs))
            )
    elif isinstance(mine, Sequence) and isinstance(theirs, Sequence):
        for first, second in zip_longest(mine.items, theirs.items):
            yield from _unlike(first, second)
    elif (
        mine is None
        or theirs is None
        or type(mine) is not type(theirs)
        or to_python(mine) != to_python(theirs)
    ):
        yield mine, theirs


def _body(node: Node | None) -> Node | None:
    """The body itself, or the one that a joint belongs to."""
    if node is None or node.tag == "body":
        return node
    return next(node.iterancestors("body"), None)


def _added_to(life: Life | None) -> Span | None:
    """Where the recipe names what it adds an element to."""
    done = None if life is None or life.made_by is None else life.made_by.done
    return done.to_span if isinstance(done, AddElement) else None


def _cause(words: str, here: Span | None, there: Span | None, side: int) -> Cause:
    """A cause that is told from one side."""
    return Cause(words, here, there) if side == 0 else Cause(words, there, here)


def _base(side: Side) -> Span | None:
    """Where a recipe names its base."""
    return None if side.plan is None else locate(side.plan.document, ("base",))


def _parts(side: Side) -> dict[str, Part]:
    """The parts of a side by what they are called."""
    if side.traced is None:
        return {}
    return {part.called: part for life in side.traced.watch.lives.values() for part in life.parts}


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
