"""The elements of both models, and the pairs of them that may be the cause of a change."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from itertools import takewhile, zip_longest
from typing import TypeAlias

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Span
from mjcompose.contrast.changes import FieldChange
from mjcompose.link.inertia import has_mass
from mjcompose.link.linking import Part
from mjcompose.link.unit_keys import VECTORS
from mjcompose.mujoco.arrays import about
from mjcompose.sides.side import Side
from mjcompose.tools.diff.recipe_lines import Recipes, name
from mjcompose.trace import query
from mjcompose.trace.trace import Life
from mjcompose.trace.traced import Traced
from mjcompose.tree.classes import class_in_force, levels, value
from mjcompose.tree.select import kind_of

_HOLDERS = ("body", "worldbody")


class SideElements:
    """The elements of one side and the places where they are written; there are none if their origin is unknown.

    `counts` has MuJoCo's number of elements of each kind; if the tree has the same number, order identifies unnamed
    elements.
    """

    def __init__(self, side: Side, counts: dict[str, int]) -> None:
        self.side = side
        self.counts = counts
        self.recipes = Recipes(side)
        self.found: dict[str, list[Node]] = defaultdict(list)
        self.named: dict[tuple[str, str], Node] = {}
        self.lives = [] if side.traced is None else list(side.traced.watch.lives.values())
        self.parts = {part.called: part for life in self.lives for part in life.parts}
        if side.traced is not None:
            for kind, node in query.kinds_in_order(side.traced.model.root):
                self.found[kind].append(node)
                name = query.name_of(node)
                if name is not None and node.tag != "worldbody":
                    self.named.setdefault((kind, name), node)
        self._bodies = {query.name_of(node): number for number, node in enumerate(self.found["body"])}
        for kind in ("exclude", "pair"):
            self.found[kind].sort(key=self._signature)

    @property
    def traced(self) -> Traced:
        """The trace, for work on a node, which only a traced side has."""
        assert self.side.traced is not None
        return self.side.traced

    def span(self, node: Node | None, attribute: str | None = None) -> Span | None:
        if node is None:
            return None
        if attribute is not None:
            return self.traced.written_at(node, attribute)
        return next((reason.span for reason in self.traced.written(self.traced.watch.life(node)) if reason.span), None)

    def written(self, node: Node | None, attribute: str | None) -> list[Span]:
        """Return the place where an attribute was first written, and the places where it was changed later."""
        if attribute is None:
            span = self.span(node)
            return [] if span is None else [span]
        return [] if node is None else self.traced.history(node, attribute)

    def class_in_force(self, node: Node) -> Span | None:
        """Return the place of the class in force for an element."""
        force = class_in_force(node)
        return None if force.attribute is None else self.span(force.writer, force.attribute)

    def life(self, node: Node | None) -> Life | None:
        return None if node is None else self.traced.watch.life(node)

    def parts_of(self, node: Node | None) -> Iterator[Part]:
        """Yield the parts that an element belongs to, the outermost first."""
        life = self.life(node)
        if life is not None:
            for each in (life, *life.sources):
                yield from reversed(each.parts)

    def compiler_settings(self, life: Life | None) -> dict[str, Span]:
        """Return where the file of an element, or the recipe, writes the compiler settings that apply to it."""
        found: dict[str, Span] = {}
        if life is not None:
            for source in (life, *life.sources):
                for each in self.lives:
                    if each.tag == "compiler" and each.root is source.root and isinstance(each.owner, str):
                        found |= {key: each.span(self.traced.model.origins, key) for key in each.attributes}
        settings = () if life is None else self.recipes.settings
        return found | {f"{key} of {name(self.side, span.file)}": span for key, span in settings}

    def like(self, mine: Life | None) -> Node | None:
        """Return the element that was read from the same line of a model as an element of the other side, or None."""
        wanted = None if mine is None else (mine.tag, mine.line, mine.attributes)
        read = (life for life in self.lives if life.made_by is None and life.gone is None)
        return next((life.node for life in read if (life.tag, life.line, life.attributes) == wanted), None)

    def key_lines(self, key: Node | None, vector: str, entry: str) -> tuple[Node | None, tuple[Span, ...]]:
        """Return the element of a key's numbers and the places where they are written, the numbers themselves first."""
        if key is None or vector not in VECTORS:
            return None, ()
        found = [each for each in self.traced.key_rows(key, vector) if query.name_of(each[0]) == entry]
        if not found:
            return None, tuple(filter(None, [self.traced.written_at(key, vector)]))
        rows = [row for _, row in found]
        reasons = [*(row.reason for row in rows), *(reason for row in rows for reason in row.on_the_way)]
        return found[0][0], tuple(dict.fromkeys(reason.span for reason in reasons if reason.span))

    def _signature(self, node: Node) -> tuple[int, int]:
        """Return the key by which MuJoCo 4.0 sorts pairs and excludes: the numbers of the two bodies."""
        bodies = []
        for end in "12":
            name = node.get(f"body{end}")
            geom = self.named.get(("geom", str(node.get(f"geom{end}"))))
            if name is None and geom is not None:
                holder = next(geom.iterancestors(*_HOLDERS), None)
                name = None if holder is None else query.name_of(holder)
            bodies.append(self._bodies.get(None if name == "world" else name, 0))
        return min(bodies), max(bodies)

    def node(self, kind: str, name: str, index: int) -> Node | None:
        """Return the element in the tree, or None if it is one of many unnamed elements or was made by MuJoCo."""
        found = self.named.get((kind, name))
        if found is not None or index < 0 or len(self.found[kind]) != self.counts.get(kind):
            return found
        return self.found[kind][index]

    def setting(self, *path: str) -> Node | None:
        """Return the element that holds a setting; if there are several sections, the last one."""
        node = None if self.side.traced is None else self.side.traced.model.root
        for tag in path:
            node = None if node is None else next(node.iterchildren(tag, reversed=True), None)
        return node

    def inside(self, node: Node, *tags: str) -> list[Node]:
        """Return the children of a body with these tags, including those in frames."""
        found = []
        for child in node.iterchildren("*"):
            if child.tag in tags:
                found.append(child)
            elif child.tag in ("frame", "replicate"):
                found += self.inside(child, *tags)
        return found

    def weighs(self, body: Node) -> bool:
        """Return whether a body has an inertial, or a geom with mass."""
        found = self.inside(body, "inertial", "geom")
        classes = self.traced.classes
        return any(each.tag == "inertial" or has_mass(each, classes) for each in found)

    def frames(self, node: Node) -> list[Node]:
        """Return the frames between an element and its body, the innermost first."""
        return list(takewhile(lambda above: above.tag not in _HOLDERS, node.iterancestors()))

    def carried(self, frame: Node) -> Part | None:
        """Return the part for which the linker created a frame."""
        made = self.traced.watch.life(frame).made_by
        return made.part if made is not None and made.is_pass else None

    def place(self, frame: Node) -> Node | None:
        """Return the site, body or frame of the model that a part is attached to."""
        part = self.carried(frame)
        if part is None or part.place.name is None:
            return None
        return self.named.get((part.place.kind, part.place.name))

    def value(self, node: Node, attribute: str) -> tuple[str | None, Node | None]:
        """Return the effective value of an attribute, and the element that writes it: this one or a default class."""
        kind = kind_of(node)
        if attribute not in kind.attributes:
            return None, None
        steps = levels(node, kind, kind.attributes[attribute], classes=self.traced.classes)
        return value(steps), next((step.writer for step in steps if step.taken), None)


INERTIAL = frozenset({"body_mass", "body_inertia", "body_ipos", "body_iquat", "body_subtreemass"})
ASSETS = {"mesh": "mesh", "material": "material", "hfield": "hfield", "texture": "texture"}
_TARGETS = {"joint": "joint", "jointinparent": "joint", "tendon": "tendon"}
_PATH = {"site": "site", "geom": "geom", "sidesite": "site", "joint": "joint"}
_POSE = about("body_pos").attributes
_AT_POSE = ("body_ipos", "body_iquat")
"""MuJoCo 3.12 to 4.0 copy the pose of a body that has no mass here."""

Pair: TypeAlias = "tuple[Node | None, Node | None, tuple[str, ...] | None]"
"""An element of A, its counterpart in B, and the attributes to compare; None for all."""


class Pairs:
    def __init__(self, a: SideElements, b: SideElements) -> None:
        self.a = a
        self.b = b

    def of_inertia(self, change: FieldChange, before: Node, after: Node) -> Iterator[Pair]:
        """Yield the elements that can change the inertia of a body: its `<inertial>`, geoms and meshes, or itself."""
        for tag in ("inertial", "geom"):
            for mine, theirs in zip_longest(self.a.inside(before, tag), self.b.inside(after, tag)):
                yield mine, theirs, None
                yield from self.referred(mine, theirs, ASSETS)
        if change.field in _AT_POSE and not (self.a.weighs(before) or self.b.weighs(after)):
            pose = about(change.field.replace("body_i", "body_")).attributes
            yield before, after, pose
            yield from self.frames(before, after, pose)

    def candidates(self, change: FieldChange, before: Node, after: Node, wanted: tuple[str, ...]) -> Iterator[Pair]:
        """Yield possible causes, the likeliest first."""
        if change.field in INERTIAL:
            yield from self.of_inertia(change, before, after)
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
            path = list(zip_longest(before.iterchildren("*"), after.iterchildren("*")))
            yield from ((mine, theirs, None) for mine, theirs in path)
            for mine, theirs in path:
                for first, second, _ in self.referred(mine, theirs, _PATH):
                    yield first, second, None
                    yield from self.above(first, second)

    def frames(self, before: Node, after: Node, wanted: tuple[str, ...]) -> Iterator[Pair]:
        """Yield the frames around an element up to its body, and the places of parts for which they are made."""
        around = zip_longest(self.a.frames(before)[::-1], self.b.frames(after)[::-1])
        for mine, theirs in (*around, (before, after)):
            if mine is not before:
                yield mine, theirs, wanted
            places = [None if node is None else side.place(node) for side, node in ((self.a, mine), (self.b, theirs))]
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
        """Yield each element that both refer to, such as a mesh or joint; `kinds` maps an attribute to its kind."""
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
        both = (before, after)
        mine, theirs = (each if each.tag == "body" else next(each.iterancestors("body"), None) for each in both)
        if mine is not None and theirs is not None:
            yield mine, theirs, _POSE
            yield from self.above(mine, theirs)
