"""A model at a glance."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, field
from pathlib import Path
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import STDIN
from mjcompose.base.report import Paint, as_lines
from mjcompose.base.rotation import Pose
from mjcompose.base.sink import Sink
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import MANIFEST
from mjcompose.bundle.manifest import from_json
from mjcompose.bundle.read import read
from mjcompose.compose.compose import ComposeOptions, Composer
from mjcompose.compose.load import Loader
from mjcompose.link import numbers
from mjcompose.link.bodies import effective_pose
from mjcompose.link.key_layout import joint_type
from mjcompose.link.measure import measure_with
from mjcompose.link.numbers import read_pose
from mjcompose.mujoco.arrays import BY_WORD
from mjcompose.plan.matrix import check_sample
from mjcompose.plan.plan import BASE
from mjcompose.plan.planner import make_plan
from mjcompose.plan.read import Given
from mjcompose.sources.context import Context
from mjcompose.sources.lock import resolve
from mjcompose.text.faults import quoted, word
from mjcompose.tree.classes import text_in_effect
from mjcompose.tree.names import WORLD
from mjcompose.tree.parse import parse_text
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import Unit


class OutlineJoint(Struct):
    """A joint; `range` is None without limits, in radians for a hinge or ball joint and in meters for a slide."""

    name: str | None
    type: str
    range: tuple[float, float] | None = None


class Place(Struct):
    """A place for attaching a part: `kind` is `site`, `body` or `frame`.

    `pose` is relative to its body, and `world` is relative to the world with all joints at their reference; in meters.
    """

    kind: str
    name: str
    pose: Pose
    world: Pose


class Body(Struct):
    """A body or the world. `part` is its part's name in the recipe; None if the recipe adds it.

    `copies` is the number of copies that MuJoCo's `<replicate>` makes. `places` has the body itself first.
    """

    name: str | None
    part: str | None
    joints: tuple[OutlineJoint, ...] = ()
    places: tuple[Place, ...] = ()
    children: tuple[Body, ...] = ()
    copies: int = 1

    def walk(self) -> Iterator[Body]:
        yield self
        for child in self.children:
            yield from child.walk()


class OutlinePart(Struct):
    """A part: its name in the recipe, the origin of its model, and the body that it is fixed to."""

    name: str
    model: str
    body: str | None = None


class Outline(Struct):
    """A model: `name` is its own name, and `label` is the user's name for it."""

    name: str
    label: str
    world: Body
    parts: tuple[OutlinePart, ...] = field(default=())

    @property
    def bodies(self) -> tuple[Body, ...]:
        return tuple(self.world.walk())[1:]

    @property
    def joints(self) -> tuple[OutlineJoint, ...]:
        return tuple(joint for body in self.world.walk() for joint in body.joints)


def as_data(outline: Outline, depth: int | None = None) -> dict[str, Any]:
    """Return parts, and every body after its parent, with its joints and places.

    `depth` limits the levels of bodies. Meters and radians; poses are relative to the body (`pos`, `quat`) and to
    the world at the reference configuration.
    """
    bodies = list(_bodies(outline.world, None, depth))
    parts = list(map(asdict, outline.parts))
    return {"name": outline.name, "model": outline.label, "parts": parts, "bodies": bodies}


def _bodies(body: Body, parent: str | None, depth: int | None) -> Iterator[dict[str, Any]]:
    places = [
        {each.kind: each.name, **asdict(each.pose), "world_pos": each.world.pos, "world_quat": each.world.quat}
        for each in body.places
    ]
    yield {
        "name": body.name,
        "parent": parent,
        "part": body.part,
        "copies": body.copies,
        "joints": list(map(asdict, body.joints)),
        "places": places,
    }
    if depth is None or depth > 0:
        for child in body.children:
            yield from _bodies(child, body.name, None if depth is None else depth - 1)


PartOf = Callable[["Node"], str | None]
_TRANSPARENT = ("frame", "replicate")
_JOINTS = ("joint", "freejoint")


_DEEPEST = 499
"""The depth of an element that MuJoCo 3.12 to 4.0 reads, the root included."""


def world_of(unit: Unit, part_of: PartOf, sink: Sink) -> Body | None:
    """Return the world with all bodies below it, or None after reporting that MuJoCo does not read it.

    `part_of` returns the part of an element by its name in the recipe.
    """
    too_deep = _first_too_deep(unit.root)
    if too_deep is not None:
        name = too_deep.get("name")
        called = f"the {too_deep.tag} `{name}`" if name else f"a {too_deep.tag}"
        message = f"MuJoCo rejects {called}: more than {_DEEPEST} elements are nested"
        sink.error("mujoco-rejects", message, unit.origins.span(too_deep, unit.file))
        return None
    worlds = list(unit.root.iterchildren("worldbody"))
    return _Outliner(unit, part_of).body(WORLD, None, holders=worlds, pose=Pose())


def _first_too_deep(root: Node) -> Node | None:
    depths = {root: 1}
    for node in root.iterdescendants("*"):
        parent = node.getparent()
        assert parent is not None
        depths[node] = depths[parent] + 1
        if depths[node] > _DEEPEST:
            return node
    return None


class _Outliner:
    def __init__(self, unit: Unit, part_of: PartOf) -> None:
        self.unit = unit
        self.part_of = part_of
        self.degrees = unit.settings.angle == "degree"
        self.sequence = unit.settings.eulerseq

    def body(self, name: str | None, part: str | None, holders: list[Node], pose: Pose, copies: int = 1) -> Body:
        """Return a body with the contents of `holders`; `pose` is its pose in the world."""
        joints: list[OutlineJoint] = []
        children: list[Body] = []
        is_named = name is not None and any(holder.tag == "body" for holder in holders)
        places = [Place("body", str(name), Pose(), world=pose)] if is_named else []
        for node, inside, times in self.members(holders, Pose(), copies):
            own = node.get("name") or None
            if node.tag in _JOINTS:
                type = "free" if node.tag == "freejoint" else joint_type(node, self.unit.classes)
                joints.append(OutlineJoint(own, type, self.range(node, type)))
            elif node.tag == "body":
                world = pose @ inside @ self.pose(node)
                children.append(self.body(own, self.part_of(node), holders=[node], pose=world, copies=times))
            elif node.tag in ("site", "frame") and own:
                place = inside @ self.pose(node)
                places.append(Place(str(node.tag), own, place, world=pose @ place))
        return Body(name, part, tuple(joints), places=tuple(places), children=tuple(children), copies=copies)

    def members(self, holders: list[Node], pose: Pose, copies: int) -> Iterator[tuple[Node, Pose, int]]:
        """Yield the contents of bodies, including frames, with the pose of their parent and the number of copies."""
        for holder in holders:
            for node in holder.iterchildren("*"):
                yield node, pose, copies
                if node.tag in _TRANSPARENT:
                    inner = pose @ self.pose(node) if node.tag == "frame" else pose
                    count = int(node.get("count") or 1) if node.tag == "replicate" else 1
                    yield from self.members([node], inner, copies * count)

    def range(self, node: Node, type: str) -> tuple[float, float] | None:
        """Return the limits in effect. `limited` decides; if it is not set, a written range counts."""
        if type == "free":
            return None
        kind = kind_of(node)
        classes = self.unit.classes
        limited = text_in_effect(node, kind, "limited", classes=classes) or "auto"
        if limited == "false" or (limited == "auto" and self.unit.settings.autolimits == "false"):
            return None
        limits = numbers.read(str(text_in_effect(node, kind, "range", classes=classes) or ""))
        if len(limits) != 2 or limits[0] >= limits[1]:
            return None
        if self.degrees and BY_WORD[type].range_unit == "rad":
            limits = [numbers.joint_radians(limit) for limit in limits]
        return limits[0], limits[1]

    def pose(self, node: Node) -> Pose:
        """Return the pose in the parent; for a site, including values from its classes."""
        attributes = effective_pose(node, self.unit.classes) if node.tag == "site" else node
        return read_pose(attributes, self.degrees, self.sequence)


_ORDER = ("site", "frame", "body")
_HEAD = ("to write", "", "pos in the world (m)", "quat in the world")
_NUMBER = re.compile(r"[-+.\d][-+.\deE_]*")


def render(outline: Outline, depth: int | None = None, color: bool = False) -> str:
    """Return parts, then bodies with their joints, down to `depth` levels; without a final line break."""
    paint = Paint(color)
    counts = [counted(len(outline.bodies), "body"), counted(len(outline.joints), "joint")]
    counts += [counted(len(outline.parts), "part")] if outline.parts else []
    width = max((len(part.name) for part in outline.parts), default=0)
    lines = [f"{paint('bold', outline.name)}: {', '.join(counts)}"]
    for part in outline.parts:
        place = f", on {part.body}" if part.body else ""
        lines.append(f"  {paint('help', f'{part.name:{width}}')}  {part.model}{paint('dim', place)}")
    return as_lines([*lines, paint("bold", "world"), *_below(outline.world, depth, paint)])


def render_places(outline: Outline, depth: int | None = None, color: bool = False) -> str:
    """Return the places for attaching parts, one on a line, in recipe syntax; bodies down to `depth` levels."""
    paint = Paint(color)
    rows = [_HEAD]
    found = list(_places(outline.world, depth, 0))
    for kind in _ORDER:
        rows += [_place(body, place) for body, place in found if place.kind == kind]
    if len(rows) == 1:
        return f"{outline.label}: nothing with a name; without `site`, `body` and `frame` a part is in the world"
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    head, *lines = (
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )
    marked = (paint("bold", line[: widths[0]]) + line[widths[0] :] for line in lines)
    return as_lines([paint("dim", head), *marked])


def _place(body: Body, place: Place) -> tuple[str, str, str, str]:
    inside = "" if place.kind == "body" else f"in {body.name or 'a body without a name'}"
    name = quoted(place.name) if _NUMBER.fullmatch(place.name) else word(place.name)
    turned = _numbers(place.world.quat)
    return f"{place.kind}: {name}", inside, _numbers(place.world.pos), "" if turned == "1 0 0 0" else turned


def _below(body: Body, depth: int | None, paint: Paint, edge: str = "") -> Iterator[str]:
    """Yield the contents of a body; if it has several joints, each on a line of its own."""
    for number, child in enumerate(body.children):
        last = number == len(body.children) - 1
        yield f"{paint('gutter', edge + ('└ ' if last else '├ '))}{_line(child, body, paint)}"
        inner = edge + ("  " if last else "│ ")
        if depth is None or depth > 1:
            yield from _below(child, None if depth is None else depth - 1, paint, edge=inner)
        elif child.children:
            hidden = list(child.walk())[1:]
            joints = sum(len(each.joints) for each in hidden)
            summary = f"… {counted(len(hidden), 'body')}, {counted(joints, 'joint')} below"
            yield paint("dim", f"{inner}└ {summary}")


def _line(body: Body, parent: Body, paint: Paint) -> str:
    name = body.name or "(no name)"
    words = [paint("bold", name) if body.name else paint("dim", name)]
    if body.copies > 1 and body.copies != parent.copies:
        words.append(paint("dim", f"×{body.copies}"))
    if body.part != parent.part and body.part not in (None, BASE):
        words.append(paint("help", f"[{body.part}]"))
    if body.joints:
        words.append("  " + ", ".join(_joint(each, paint) for each in body.joints))
    return " ".join(words)


def _joint(joint: OutlineJoint, paint: Paint) -> str:
    name = f"{paint('code', joint.name)} " if joint.name else ""
    if joint.range is None:
        return f"{name}{joint.type}"
    is_slide = joint.type == "slide"
    low, high = (f"{round(each, 4):g}" if is_slide else f"{round(math.degrees(each), 1):g}" for each in joint.range)
    limits = f" ±{high}" if low == f"-{high}" else f" {low}…{high}"
    return f"{name}{joint.type}{paint('dim', limits + (' m' if is_slide else '°'))}"


def _places(body: Body, depth: int | None, level: int) -> Iterator[tuple[Body, Place]]:
    yield from ((body, place) for place in body.places)
    if depth is None or level < depth:
        for child in body.children:
            yield from _places(child, depth, level + 1)


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{round(value, 4) + 0.0:g}" for value in values)


_ARCHIVES = (".zip", ".mjz")


def outline(text: str, context: Context, given: Given | None = None, sample: int = 0) -> Outline | None:
    """Return the outline of `text`, or None after errors, which are in `context.sink`.

    Nothing is compiled except the units that the linker has to measure. `given` are values of a recipe's parameters and
    variants, and `sample` selects its draws.
    """
    path = context.folder / text
    if text == STDIN:
        return _of_recipe(path, text, context, given=given, sample=sample)
    if os.path.isdir(path) or (path.suffix.lower() in _ARCHIVES and "#" not in text):
        return _of_bundle(path, text, context)
    # An existing file is a path, whatever colons it has.
    reference = text if not os.path.exists(path) or path.is_absolute() else os.path.join(".", text)
    source = None
    with context.sink:
        source = resolve(
            reference, relative_to=context.folder, environment=context.environment, fetching=context.fetching
        )
    if source is None:
        return None
    if source.format == "recipe":
        return _of_recipe(source.path, text, context, given=given, sample=sample)
    for name, node in (given or {}).items():
        context.sink.error("unknown-name", f"`{text}` is not a recipe and has no parameter `{name}`", node.span)
    unit = None if given else Loader(context).unit(source, None, True)
    world = None if unit is None else world_of(unit, lambda _: None, context.sink)
    return None if unit is None or world is None else Outline(unit.model or unit.label, text, world)


def _of_recipe(path: Path, text: str, context: Context, given: Given | None, sample: int) -> Outline | None:
    plan = make_plan(path, context, given, sample=sample)
    if plan is None or not check_sample(plan, sample, context.sink):
        return None
    composer = Composer(context, measure_with(context), options=ComposeOptions(notes_parts=True))
    composed = composer.compose(plan)
    if composed is None:
        return None
    parts = tuple(
        OutlinePart(
            each.part,
            context.shown(each.source.path) if each.source.origin is None else each.source.reference,
            each.body,
        )
        for each in composed.members
    )
    part_of = _part_of(composed.model, composer.parts, plan.separator)
    world = world_of(composed.model, part_of, context.sink)
    return None if world is None else Outline(plan.name, text, world, parts=parts)


def _part_of(model: Unit, parts: dict[Node, str], separator: str) -> PartOf:
    """Return a function for the part of an element in a composition: a part, the base, or (None) the recipe itself."""

    def part_of(node: Node) -> str | None:
        part = parts.get(node)
        if part is not None:
            return part
        if isinstance(model.origins.owner(node, model.file), str):
            return BASE
        # A part with a joint of its own is in a body that the linker created for it.
        inside = (parts.get(each) for each in node.iter("body"))
        return next((each for each in inside if each and f"{each}{separator}" == node.get("name")), None)

    return part_of


def _of_bundle(path: Path, text: str, context: Context) -> Outline | None:
    unit = None
    with context.sink:
        bundle = read(path, shown=text)
        unit = parse_text(bundle.files[bundle.model], context.sink, file=bundle.model, directory=path, label=path.stem)
    if unit is None:
        return None
    manifest = None
    if MANIFEST in bundle.files:
        try:
            manifest = from_json(bundle.files[MANIFEST])
        except ValueError:
            context.sink.warning("bundle-manifest", f"the manifest of `{text}` cannot be read: parts are not known")
    members = () if manifest is None else manifest.parts
    parts = tuple(
        OutlinePart(each.part, manifest.inputs[each.input].reference, each.body) for each in members if manifest
    )

    def part_of(node: Node) -> str | None:
        """Return the part with the longest matching prefix; others may belong to the base or the recipe."""
        name = str(node.get("name") or "")
        fitting = [each for each in members if each.prefix and name.startswith(each.prefix)]
        return max(fitting, key=lambda each: len(each.prefix)).part if fitting else None

    world = world_of(unit, part_of, context.sink)
    return None if world is None else Outline(unit.model or unit.label, text, world, parts=parts)
