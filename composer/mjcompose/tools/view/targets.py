"""Parts and added elements whose place a recipe sets. The page can move them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Path as Steps, Span
from mjcompose.base.files import RECIPES
from mjcompose.base.rotation import Pose
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.link.bodies import effective_pose
from mjcompose.link.linking import Part
from mjcompose.link.numbers import pose_in_world, read_pose
from mjcompose.plan.plan import Plan
from mjcompose.plan.steps import AddElement
from mjcompose.sides.side import Side
from mjcompose.text.node import Mapping as Located, find, walk
from mjcompose.tools.view.page import nodes_of
from mjcompose.tree.classes import through_frames
from mjcompose.tree.files import read_settings

KINDS = ("body", "geom", "site", "camera")


class MovableItem(Struct):
    """A part or an added element: the recipe that sets its place, and the path of its mapping there.

    `outer` are the prefixes that the names of its recipe have in the model, one for each use of the recipe. With
    `is_shared`, several turns of a `for` read the same row of a table.
    """

    label: str
    plan: Plan
    at: Steps
    span: Span
    outer: tuple[str, ...] = ()
    is_shared: bool = False

    @property
    def is_repeated(self) -> bool:
        """Whether a turn of a `for` has made it."""
        return self.span.turn is not None or self.mapping.span.turn is not None

    @property
    def columns(self) -> dict[str, Span]:
        """The places in a table that have the values of its offset, by key; empty if something else has one."""
        keys = [key for key in ("pos", *ORIENTATIONS) if key in self.mapping.entries]
        places = {key: self.mapping.entries[key][1].span.source for key in keys}
        return {key: place for key, place in places.items() if place is not None} if all(places.values()) else {}

    @property
    def mapping(self) -> Located:
        found = find(self.plan.document, self.at)
        return found if isinstance(found, Located) else Located({}, self.span)


class MovableItems(Struct):
    """All targets of a model by the place of their key, and the text of each recipe by its name in messages.

    `texts` has None for a recipe that changed during the build, and `paths` only the recipes of the user's own.
    """

    recipe: str = ""
    by_place: Mapping[tuple[str, int, int], MovableItem] = field(default_factory=dict)
    texts: Mapping[str, bytes | None] = field(default_factory=dict)
    paths: Mapping[str, Path] = field(default_factory=dict)
    plan: Plan | None = None


def movable(
    side: Side, scene: Mapping[str, Any], texts: Mapping[str, bytes | None]
) -> tuple[dict[str, Any], MovableItems]:
    """Return the table of movable elements for the page and for the server."""
    operand = side.operand
    folder = operand.context.folder
    is_recipe = not operand.revision and operand.path.suffix.lower() in RECIPES
    is_known = side.plan is not None and side.traced is not None and is_recipe
    if side.plan is None or not is_known or not (folder / side.plan.file).samefile(folder / operand.label):
        return {"why": "only a recipe can be changed here: write one with `base: ./MODEL.xml`"}, MovableItems()
    found = _Movable(side, scene, texts)
    rows = [*found.parts(), *found.additions()]
    paths = {name: path for name in texts if operand.fetched(path := folder / name) is None}
    names = list(texts)
    for row in rows:
        row["at"][0] = names.index(row["at"][0])
    page = {"files": names, "targets": rows, "framed": found.framed()}
    return page, MovableItems(side.plan.file, found.targets, texts, paths=paths, plan=side.plan)


class _Movable:
    def __init__(self, side: Side, scene: Mapping[str, Any], files: Collection[str]) -> None:
        self.files = files
        assert side.traced is not None and side.plan is not None
        self.traced = side.traced
        self.plans = list(side.plan.plans())
        found = {kind: nodes_of(kind, scene[kind]["name"], side.traced) for kind in KINDS}
        pairs = ((kind, each) for kind, nodes in found.items() for each in enumerate(nodes))
        self.numbers = {node: (kind, number) for kind, (number, node) in pairs if node is not None}
        settings = read_settings(side.traced.model.root)
        self.units = settings.angle == "degree", settings.eulerseq
        self.targets: dict[tuple[str, int, int], MovableItem] = {}

    def parts(self) -> Iterator[dict[str, Any]]:
        """Yield a row for each part and each of its copies."""
        steps = {_turn_of(step.span): (plan, step.at) for plan in self.plans for step in plan.parts}
        for part in dict.fromkeys(part for node in self.numbers for part in self.traced.watch.life(node).parts):
            attachment = self.traced.watch.attachment(part)
            if attachment is None or part.span is None or _turn_of(part.span) not in steps or not part.span.file:
                continue
            moves = bool(part.joints or part.mocap)
            top = _top(attachment.content, moves)
            if top is None:
                continue
            plan, at = steps[_turn_of(part.span)]
            whole_prefix = str(attachment.content.get("childclass") or part.prefix)
            is_outer = plan is self.plans[0] or not whole_prefix.endswith(part.prefix)
            outer = "" if is_outer else whole_prefix.removesuffix(part.prefix)
            target = MovableItem(part.key, plan, at, span=part.span, outer=(outer,))
            nodes = [top] if moves else list(through_frames(top))
            yield self._row(target, "part", nodes, place=self._place(part, attachment.mount, top))

    def additions(self) -> Iterator[dict[str, Any]]:
        """Yield a row for each element that `add` writes."""
        known = {}
        for plan in self.plans:
            for path, key, node in walk(find(plan.document, ("add",)) or Located({}, plan.span), ("add",)):
                if isinstance(node, Located) and len(path) > 2:
                    span = node.span if key is None else key.span
                    known[span.file, span.line, span.column] = plan, path
        for node, (kind, _) in self.numbers.items():
            life = self.traced.watch.life(node)
            if life.made_by is None or not isinstance(life.made_by.done, AddElement):
                continue
            written = next((each.span for each in self.traced.written(life) if each.span is not None), None)
            if written is not None and (found := known.get((written.file, written.line, written.column))) is not None:
                target = MovableItem(str(node.get("name") or kind), *found, span=written)
                yield self._row(target, kind, [node], place=(node.getparent(), Pose()))

    def framed(self) -> dict[str, list[int]]:
        """Return the elements in frames of their source, whose own `pos` is not their place in the body."""
        found: dict[str, list[int]] = {}
        for node, (kind, number) in self.numbers.items():
            parent = node.getparent()
            if parent is not None and parent.tag in ("frame", "replicate"):
                found.setdefault(kind, []).append(number)
        return found

    def _place(self, part: Part, mount: Node, top: Node) -> tuple[Node | None, Pose]:
        """Return the element in which the offset of a part counts, and the pose of the place there."""
        kind = part.place.kind
        if kind == "world" or (part.sense is not None and not part.floats):
            return top.getparent(), Pose()
        start = mount
        pose = Pose()
        if kind == "site":
            parent = mount.getparent()
            if parent is None:
                return None, pose
            start = parent
            pose = read_pose(effective_pose(mount, self.traced.classes), *self.units)
        if part.floats:
            return top.getparent(), pose_in_world(start, *self.units) @ pose
        return start, pose

    def _row(
        self, target: MovableItem, kind: str, nodes: list[Node], place: tuple[Node | None, Pose]
    ) -> dict[str, Any]:
        span = next(iter(target.columns.values()), target.span) if target.is_repeated else target.span
        span = span if span.file in self.files else target.span
        at = (span.file, span.line, span.column)
        earlier = self.targets.get(at)
        if earlier is not None:
            outer = tuple(dict.fromkeys([*earlier.outer, *target.outer]))
            target = replace(target, outer=outer, is_shared=target.is_repeated and earlier.label != target.label)
        self.targets[at] = target
        moved: dict[str, list[int]] = defaultdict(list)
        for of, number in (self.numbers[node] for node in nodes if node in self.numbers):
            moved[of].append(number)
        start, pose = place
        while start is not None and start.tag == "frame":
            pose = read_pose(start, *self.units) @ pose
            start = start.getparent()
        mount = None if start is None else self.numbers.get(start)
        frame = None if mount is None or not pose.is_finite else [*pose.pos, *pose.quat]
        number = mount[1] if mount else 0
        return {"at": [*at], "label": target.label, "kind": kind, "mount": number, "frame": frame, "moved": moved}


def _top(content: Node, moves: bool) -> Node | None:
    """Return the element that holds a part in the model. The body around its frame holds a part that moves."""
    top = content.getparent() if moves and content.tag == "frame" else content
    return top if top is not None and top.tag in ("frame", "body") else None


def _turn_of(span: Span) -> tuple[Span, str | None]:
    """Return a place with the turn of the `for` that repeats it, which spans do not compare."""
    return span, span.turn
