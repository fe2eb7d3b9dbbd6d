"""Changes as data, and the pairs of elements that may be their cause."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from itertools import takewhile, zip_longest
from typing import Literal, TypeAlias

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Span
from mjcompose.link.inertia import has_mass
from mjcompose.link.linking import Part
from mjcompose.mujoco.arrays import about
from mjcompose.mujoco.attributes import KINDS
from mjcompose.tools.explain import query
from mjcompose.tools.explain.explain import Traced
from mjcompose.tree.classes import levels, value
from mjcompose.tree.select import kind_of
from mjcompose.tree.select import query as paths_of

Value: TypeAlias = bool | int | float | str | tuple["Value", ...] | None

What: TypeAlias = Literal["added", "removed", "renamed", "changed"]

SETTINGS = ("option", "visual", "statistic")
"""Kinds that are settings of the whole model, not elements."""


@dataclass(frozen=True, slots=True)
class Change:
    """One difference.

    ``kind`` is MJCF's word for the element, or one of ``SETTINGS``. ``name`` is its name in B, or in A if B lacks it.
    An unnamed element is reported by its place. ``field`` is the array of `mjModel`, or the setting; it is empty if the
    element itself is ``added``, ``removed`` or ``renamed``. ``form`` is the type of the joint that determines the unit.
    ``entry`` names the owner of a number in a keyframe. ``index`` are the ids in A and B, -1 for none. ``follows`` says
    that MuJoCo computes the value from others that are reported too. ``note`` describes a change that is too long to
    list.
    """

    what: What
    kind: str
    name: str
    field: str = ""
    before: Value = None
    after: Value = None
    form: str = ""
    entry: str = ""
    index: tuple[int, int] = (-1, -1)
    name_before: str = ""
    follows: bool = False
    note: str = ""


@dataclass(frozen=True, slots=True)
class Move:
    """An element whose address in a vector of the whole model changed; addresses count from 0."""

    vector: str
    kind: str
    name: str
    before: int
    after: int


@dataclass(frozen=True, slots=True)
class Count:
    """A size of the whole model."""

    name: str
    before: float
    after: float
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Contrast:
    """All differences between two compiled models.

    ``identical`` says that every array of `mjModel` is equal bit for bit; ``arrays`` names those that are not.
    ``elements`` has the counts in A and B by kind.
    """

    identical: bool
    changes: tuple[Change, ...]
    moves: tuple[Move, ...]
    counts: tuple[Count, ...]
    arrays: tuple[str, ...]
    elements: dict[str, tuple[int, int]]


@dataclass(frozen=True, slots=True)
class Cause:
    """Where the cause of a difference is written: a place in A, in B, or in both, and the lines that differ."""

    words: str
    before: Span | None = None
    after: Span | None = None
    lines_before: tuple[str, ...] = ()
    lines_after: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Group:
    """The changes that one line causes; ``cause`` is None if no line is known."""

    cause: Cause | None
    changes: tuple[Change, ...]


@dataclass(frozen=True, slots=True)
class End:
    """A or B: its name in messages, its kind, and the sha256 of its files without the manifest.

    `cell` is the cell of its matrix that was compared. Without it, `cells` is the number of cells. `outside` are the
    files of a git revision that are not in its repository, and are taken as they are now.
    """

    label: str
    kind: str
    sha256: str
    cell: str | None = None
    cells: int = 0
    outside: tuple[str, ...] = ()

    @property
    def said_outside(self) -> str:
        """A sentence about the files that are not of the revision, or an empty text."""
        if not self.outside:
            return ""
        more = f" and {len(self.outside) - 3} more" if len(self.outside) > 3 else ""
        named = ", ".join(f"`{each}`" for each in self.outside[:3])
        return f"{named}{more}: outside of the repository, as now in the work tree"

    @property
    def named(self) -> str:
        return self.label if self.cell is None else f"{self.label}: {self.cell}"


@dataclass(frozen=True, slots=True)
class View:
    """Pictures of A and B from one place, named after the camera; ``differs`` is the share of differing pixels."""

    name: str
    before: str
    after: str
    differs: float


@dataclass(frozen=True, slots=True)
class Diff:
    """The result. ``same`` says that nothing in the requested scope differs; ``files`` are those whose bytes differ."""

    a: End
    b: End
    contrast: Contrast
    groups: tuple[Group, ...]
    files: tuple[str, ...]
    follows: int
    views: tuple[View, ...] = ()

    @property
    def same(self) -> bool:
        contrast = self.contrast
        return not (self.groups or self.follows or contrast.moves or contrast.counts or contrast.arrays)

    @property
    def same_bytes(self) -> bool:
        return self.a.sha256 == self.b.sha256


LEVELS = ("major", "minor", "patch")


@dataclass(frozen=True, slots=True)
class Level:
    """The changes of one level, which is one of `LEVELS`."""

    name: str
    groups: tuple[Group, ...]
    moves: tuple[Move, ...]
    arrays: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Breaking:
    """A diff by levels, the most important first; levels without changes are missing."""

    diff: Diff
    levels: tuple[Level, ...]


_HOLDERS = ("body", "worldbody")
_KINDS = {path: kind for kind in KINDS if kind != "plugin" for path in paths_of(kind, None).paths}


class Elements:
    """The elements of one model.

    `counts` has MuJoCo's number of elements of each kind; if the tree has as many, order identifies unnamed
    elements.
    """

    def __init__(self, traced: Traced, counts: dict[str, int]) -> None:
        self.traced, self.counts = traced, counts
        self.root = traced.model.root
        self.found: dict[str, list[Node]] = defaultdict(list)
        self.named: dict[tuple[str, str], Node] = {}
        for node in query.ordered(self.root):
            kind = "body" if node.tag == "worldbody" else _KINDS.get(kind_of(node).path)
            if kind is None or (node.tag == "worldbody" and self.found["body"]):
                continue
            self.found[kind].append(node)
            if (name := query.name_of(node)) is not None and node.tag != "worldbody":
                self.named.setdefault((kind, name), node)
        self._bodies = {query.name_of(node): number for number, node in enumerate(self.found["body"])}
        for kind in ("exclude", "pair"):
            self.found[kind].sort(key=self._signature)

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
        """Return the element in the tree, or None if it is one of many unnamed ones or made by MuJoCo."""
        found = self.named.get((kind, name))
        if found is not None or index < 0 or len(self.found[kind]) != self.counts.get(kind):
            return found
        return self.found[kind][index]

    def setting(self, *path: str) -> Node | None:
        """Return the element that holds a setting; if there are several sections, the last one."""
        node: Node | None = self.root
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
        found, classes = self.inside(body, "inertial", "geom"), self.traced.classes
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
    def __init__(self, a: Elements, b: Elements) -> None:
        self.a, self.b = a, b

    def candidates(self, change: Change, before: Node, after: Node, wanted: tuple[str, ...]) -> Iterator[Pair]:
        """Yield possible causes, the likeliest first."""
        if change.field in INERTIAL:
            for tag in ("inertial", "geom"):
                for mine, theirs in zip_longest(self.a.inside(before, tag), self.b.inside(after, tag)):
                    yield mine, theirs, None
                    yield from self.referred(mine, theirs, ASSETS)
            if change.field in _AT_POSE and not (self.a.weighs(before) or self.b.weighs(after)):
                pose = about(change.field.replace("body_i", "body_")).attributes
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
            path = list(zip_longest(before.iterchildren("*"), after.iterchildren("*")))
            yield from ((mine, theirs, None) for mine, theirs in path)
            for mine, theirs in path:
                for first, second, _ in self.referred(mine, theirs, _PATH):
                    yield first, second, None
                    yield from self.above(first, second)

    def frames(self, before: Node, after: Node, wanted: tuple[str, ...]) -> Iterator[Pair]:
        """Yield the frames around an element up to its body, and the places of parts that they or it are made for."""
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
