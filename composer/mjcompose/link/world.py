"""Passes: the part's elements in the world, and its sections outside the body tree."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.rotation import Pose, Quat, multiply, normalize, rotate
from mjcompose.base.words import after_noun
from mjcompose.link import numbers
from mjcompose.link.additions import BRINGS
from mjcompose.link.key_layout import joint_type
from mjcompose.link.linking import Floating, Linking, Part
from mjcompose.link.numbers import pose_below, pose_in_world
from mjcompose.link.subtree import side_of_world
from mjcompose.tree import journal
from mjcompose.tree.classes import childclass_of, text_in_effect, through_frames
from mjcompose.tree.edit import whole
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.journal import because, explained
from mjcompose.tree.names import WORLD, users
from mjcompose.tree.parse import above
from mjcompose.tree.unit import Unit


def roots(linking: Linking) -> None:
    """Weld the parts as requested, and record elements that MuJoCo does not allow below a body."""
    for part in linking.parts:
        if part.by_itself:
            continue
        bodies = [body for body in _top_level(part.unit.root) if body.tag == "body"]
        all_free = floats_by_itself(part.unit)
        all_mocap = floats_by_itself(part.unit, mocap=True)
        for body in bodies:
            called = f"body `{body.get('name')}`" if body.get("name") else "body, which has no name"
            for joint in list(_own_joints(body)):
                if joint_type(joint, part.unit.classes) != "free":
                    continue
                if part.weld:
                    journal.remove(joint, because("removed: `joint: none` fixes the part in its place", part.span))
                else:
                    linking.notes.floating.append(Floating(part, body, joint, called=called, alone=all_free))
            if body.get("mocap") == "true":
                linking.notes.floating.append(Floating(part, body, None, called=called, alone=all_mocap))
        if part.place.kind != "world" or part.has_body:
            _note_planes(linking, part)


def check_roots(linking: Linking) -> None:
    """Refuse free joints, mocap bodies and planes below a body. Frames of the world are not bodies."""
    # MuJoCo 4.0: "free joint can only be used on top level". A frame of the world does not count as a body:
    # `<frame><body><freejoint/>…` is right, and so is a mocap body there.
    by_cause: dict[tuple[Span, bool], list[Floating]] = {}
    for floating in linking.notes.floating:
        if next(floating.body.iterancestors("body"), None) is not None:
            span = floating.part.place.span or floating.part.span or _floating_span(linking, floating)
            by_cause.setdefault((span, floating.joint is None), []).append(floating)
    for (span, _), alike in by_cause.items():
        _report_floating(linking, alike, span)
    for part, geom in linking.notes.planes:
        if _moves(geom):
            why = "MuJoCo allows planes only on static bodies"
            message = f"`{part.called}` contains a plane and is attached {_place_words(part)}, which moves: {why}"
            help = "attach the part to the world or to a static body, or remove the plane from its file"
            notes = (Note("the plane", linking.span(linking.base, geom)),)
            span = part.place.span or part.span or linking.span(part.unit, geom)
            linking.sink.error("plane-on-body", message, span, notes=notes, help=help, subjects=(part.called,))


def floats_by_itself(unit: Unit, *, mocap: bool = False) -> bool:
    """Return whether a unit is only bodies with free joints, or with `mocap` only mocap bodies."""
    top = list(_top_level(unit.root))
    if not top or any(element.tag != "body" for element in top):
        return False
    if mocap:
        return all(body.get("mocap") == "true" for body in top)
    return all(any(joint_type(joint, unit.classes) == "free" for joint in _own_joints(body)) for body in top)


def _top_level(root: Node) -> Iterator[Node]:
    for worldbody in root.iterchildren("worldbody"):
        yield from through_frames(worldbody)


def _own_joints(body: Node) -> Iterator[Node]:
    yield from (child for child in through_frames(body) if child.tag in ("freejoint", "joint"))


def _place_words(part: Part) -> str:
    if part.place.kind == "world":
        return f"to the body that `{_added_by(part)}` gives it"
    return f"to the {part.place.kind} `{part.place.name}`"


def _added_by(part: Part) -> str:
    return "joint" if part.joints or part.mocap else "sense"


def _floating_span(linking: Linking, floating: Floating) -> Span:
    moving = floating.body if floating.joint is None else floating.joint
    return linking.span(floating.part.unit, moving)


def _report_floating(linking: Linking, alike: list[Floating], place: Span) -> None:
    """Report the first of the bodies that move freely and are attached to the same place, all by joints or none."""
    part, _, joint, called, alone = alike[0]
    omit = f"omit `{_added_by(part) if part.place.kind == 'world' else part.place.kind}`"
    if joint is None:
        code = "mocap-on-body"
        what = "mocap body"
        note = f"the mocap {called}"
        if part.place.kind != "world" and alone:
            help = "write `joint: mocap` to put it into the world at the pose of that place"
        else:
            help = f"{omit}: then it is attached to the world"
    else:
        code = "freejoint-on-body"
        what = "free joint"
        note = f"the free joint of {called}"
        if part.place.kind == "world":
            help = f"{omit}: the part floats in the world by its own free joint"
        else:
            away = "`joint: free`" if alone else omit
            there = " from there" if alone else ""
            help = f"write `joint: none` to fix it there, or {away} to let it float in the world{there}"
        if part.joints or part.mocap:
            drop = "drop: [freejoint]" if joint.tag == "freejoint" else "drop: [{joint: NAME}]"
            help = f"write `{drop}` so it moves only by the added `joint`, or {help.removeprefix('write ')}"
    why = f"MuJoCo allows {'mocap bodies' if joint is None else 'free joints'} only in the world"
    message = f"`{part.called}` has a {what} at its root and cannot be attached {_place_words(part)}: {why}"
    notes = [Note(note, _floating_span(linking, alike[0]))]
    if more := len(alike) - 1:
        notes.append(Note(f"and {more} more"))
    subjects = tuple(dict.fromkeys(floating.part.called for floating in alike))
    linking.sink.error(code, message, place, notes=notes, help=help, subjects=subjects)


def _note_planes(linking: Linking, part: Part) -> None:
    # MuJoCo 4.0 refuses `<body><joint/><geom type="plane" size="1 1 1"/></body>`: planes are "only allowed in static
    # bodies".
    root = part.unit.root
    classes = part.unit.classes
    by_class = any(geom.get("type") == "plane" for geom in root.iterfind("default//geom"))
    for geom in root.iterfind("worldbody//geom"):
        kind = classes.effective(geom, childclass_of(geom), "type") if by_class else geom.get("type")
        if kind == "plane" and not _moves(geom):
            linking.notes.planes.append((part, geom))


def _moves(geom: Node) -> bool:
    return any(
        body.get("mocap") == "true" or next(_own_joints(body), None) is not None for body in geom.iterancestors("body")
    )


_SAME = 1e-9
_OF_THE_WORLD = ("sensor", "custom")
_APPENDED = ("asset", "deformable", "contact", "tendon", "equality", "actuator", "sensor", "custom")


def worlds(linking: Linking) -> None:
    """Make references to the world of each part refer to the body that carries it, and move poses in its world.

    Sensors and tuples keep the world: they measure or list it, and nothing holds the part there. In MuJoCo 4.0 a sensor
    with `reftype="body" refname="world"` reads the same as one without a reference. On a body it would measure in the
    body's inertial frame, which is not a frame of the part.

    MuJoCo's own attach changes none of this: in 4.0 a `<weld body1="b"/>` pulls an attached part back to its pose in
    its file, and on a moving body it fixes the part to the world.
    """
    degrees = linking.angle == "degree"
    sequence = linking.base.settings.eulerseq
    for part in linking.parts:
        if part not in linking.attachments:
            continue
        content = linking.attachments[part].content
        pose, holder, copied = pose_below(content, degrees, sequence)
        named = holder.get("name") if holder not in linking.notes.nameless else ""
        name = WORLD if holder.tag == "worldbody" else str(named or "")
        hung = _MovedWorld(part, content, pose, holder, name=name, copied=copied)
        if copied is not None or holder.tag == "body" or not pose.is_identity:
            _rename_world(linking, hung)
            _check_targets(linking, hung)
            _check_attached(linking, hung)
        _check_free_motors(linking, hung, degrees, sequence=sequence)
        _check_flexes(linking, hung)


class _MovedWorld(NamedTuple):
    """A part, the content of its world and its pose in its holder, its name, and a `<replicate>` between them."""

    part: Part
    content: Node
    pose: Pose
    holder: Node
    name: str
    copied: Node | None


def _rename_world(linking: Linking, hung: _MovedWorld) -> None:
    """Change the references to the world of equalities, excludes and the like, and the anchors of equalities."""
    refused: list[Node] = []
    for section in hung.part.unit.root.iterchildren(*_APPENDED):
        if section.tag in _OF_THE_WORLD:
            continue
        naming: dict[Node, list[tuple[Node, str]]] = {}
        for node, attribute in users(section, "body", WORLD):
            naming.setdefault(whole(node), []).append((node, attribute))
        is_equality = section.tag == "equality"
        elements = section.iterchildren("*") if is_equality else naming
        for element in elements:
            side = side_of_world(element) if is_equality else None
            named = naming.get(element, [])
            if (side is not None and hung.copied is not None) or ((named or side) and not hung.name):
                refused.append(element)
                continue
            if side is not None:
                _carry_constraint(element, side, hung)
            if hung.name != WORLD:
                for node, attribute in named:
                    journal.write(node, attribute, hung.name)
    if refused:
        _refuse(linking, hung, refused)


def _refuse(linking: Linking, hung: _MovedWorld, found: list[Node]) -> None:
    part = hung.part
    first = found[0]
    named = after_noun(first.get("name"))
    more = f" ({len(found) - 1} more such elements)" if len(found) > 1 else ""
    if hung.copied is not None and hung.name:
        why = "a `<replicate>` copies it"
        note = Note("here", linking.span(linking.base, hung.copied))
        help = "omit it (`drop`), or attach the part in the model with the `<replicate>`"
    else:
        why = "that body has no name"
        note = Note("the body", linking.span(linking.base, hung.holder))
        help = 'name it, in its part: `edit: [{select: {body: "**", where: {name: ""}}, rename: "b${index}"}]`'
    what = f"{first.tag}{named} of `{part.called}` refers to the world, which becomes the body that carries the part"
    span = linking.span(part.unit, first)
    subjects = (part.called,)
    linking.sink.error("attach-place", f"{what}: {why}{more}", span, notes=(note,), help=help, subjects=subjects)


def _carry_constraint(element: Node, side: str, hung: _MovedWorld) -> None:
    """Move the anchors of a `connect` or a `weld` from the part's world into the frame of the part's parent."""
    pose = hung.pose
    journal.write(element, side, hung.name)
    if element.tag == "connect":
        if side == "body1":  # the anchor is in the frame of the first body
            journal.write(element, "anchor", _moved_pose(element, pose))
        return
    relative = numbers.read(str(element.get("relpose") or "")) or [0.0] * 7
    point = (relative[0], relative[1], relative[2])
    turn = relative[3:]
    # MuJoCo 4.0 takes the pose at the reference where the quaternion of `relpose` is 0. Otherwise it holds the point of
    # the second body that `anchor` gives at the point of the first that `relpose` gives.
    if any(turn):
        quat: Quat = normalize(turn)
        point, quat = (
            ((pose @ Pose(point)).pos, multiply(pose.quat, quat))
            if side == "body1"
            else (point, multiply(quat, pose.inverse().quat))
        )
        journal.write(element, "relpose", numbers.text([*point, *quat]))
    if side == "body2":
        journal.write(element, "anchor", _moved_pose(element, pose))


def _moved_pose(element: Node, pose: Pose) -> str:
    x, y, z = numbers.read(str(element.get("anchor") or "")) or (0.0, 0.0, 0.0)
    return numbers.text((pose @ Pose((x, y, z))).pos)


def _check_attached(linking: Linking, hung: _MovedWorld) -> None:
    """Report equalities with the world in a model that the part attaches itself: MuJoCo does not move them."""
    models = {str(each.get("name")): each for each in hung.part.unit.root.iterfind("asset/model")}
    for attach in hung.content.iter("attach"):
        element = models.get(str(attach.get("model")))
        root = None if element is None else linking.notes.attached.get(element)
        if root is None or element is None:
            continue
        taken = [each for each in root.iterfind("worldbody//body") if each.get("name") == attach.get("body")]
        names = {each.get("name") for top in taken or [root] for each in top.iter("body")}
        for equality in root.iterfind("equality/*"):
            side = side_of_world(equality)
            if side is None or equality.get("body2" if side == "body1" else "body1") not in names:
                continue
            called = f"the {equality.tag} `{equality.get('name') or ''}`"
            subjects = (hung.part.called,)
            which = f"of a model that `{hung.part.called}` attaches itself"
            message = f"{called} {which} is about the world, and MuJoCo does not carry it along"
            help = "attach that model in a recipe, or remove the equality from it"
            span = linking.span(hung.part.unit, attach)
            linking.sink.error("not-supported", message, span, help=help, subjects=subjects)
            break


def _check_targets(linking: Linking, hung: _MovedWorld) -> None:
    """Warn about cameras and lights that look at the world's origin, which no longer is the part's origin."""
    for element in hung.content.iter("camera", "light"):
        if element.get("target") != WORLD:
            continue
        if hung.name:
            journal.write(element, "target", hung.name)
        if hung.pose.pos != (0.0, 0.0, 0.0) or not hung.name:
            at = "the origin of the world" if hung.name in ("", WORLD) else f"the body `{hung.name}`"
            _warn(
                linking,
                hung.part,
                element,
                what=f"looks at {at}, and not at the origin of `{hung.part.called}`",
                help="add a body there in the part, and let it look at that",
            )


def _check_free_motors(linking: Linking, hung: _MovedWorld, degrees: bool, sequence: str) -> None:
    """Warn about actuators that push a free body of a turned part along the axes of the world."""
    free = [
        actuator for actuator in hung.part.unit.root.iterfind("actuator/*") if _acts_on_free_joint(linking, actuator)
    ]
    # The pose takes a look at everything around the part.
    turn = pose_in_world(hung.content, degrees, sequence).quat if free else (1.0, 0.0, 0.0, 0.0)
    if abs(turn[0]) == 1.0:
        return
    unit = linking.base
    kind = GRAMMAR.element("actuator/general")
    for actuator in free:
        gear = numbers.read(str(text_in_effect(actuator, kind, "gear", classes=unit.classes) or "1"))
        push, twist = ([*gear, *[0.0] * 6][at : at + 3] for at in (0, 3))
        # MuJoCo 4.0 turns a free body about its own axes, or about the world's axes with `jointinparent`.
        along = [push, twist] if actuator.get("jointinparent") else [push]
        if any(math.dist(rotate(turn, each), each) > _SAME * max(map(abs, each)) for each in along if any(each)):
            what = f"pushes along the axes of the world, which differ for `{hung.part.called}`: it is turned"
            help = "let it act on a site of the body: its `gear` is in the axes of the site"
            _warn(linking, hung.part, actuator, what=what, help=help)


def _acts_on_free_joint(linking: Linking, actuator: Node) -> bool:
    name = actuator.get("joint") or actuator.get("jointinparent")
    joint = linking.names.find("joint", str(name)) if name else None
    return joint is not None and joint_type(joint, linking.base.classes) == "free"


def _check_flexes(linking: Linking, hung: _MovedWorld) -> None:
    """Warn about flexes in the world of a moved part that MuJoCo lays out by axes or the origin of the part's parent.

    MuJoCo 4.0 moves the vertices with the frame around the flex, and makes slides and nodes from them afterwards. With
    three slides for each vertex (`full`), the axes do not matter.
    """
    if hung.pose.is_identity:
        return
    turned = abs(hung.pose.quat[0]) != 1.0
    around = f"the body `{hung.name}`" if hung.holder.tag == "body" else "the world"
    for flex in linking.notes.flexes:
        dof = str(flex.element.get("dof") or "full")
        if flex.part is not hung.part or dof == "full" or not (turned or dof == "radial"):
            continue
        where = (
            f"slides away from the origin of {around}, and not of"
            if dof == "radial"
            else f"is laid out along the axes of {around}, and not of"
        )
        _warn(
            linking,
            hung.part,
            flex.element,
            what=f'has `dof="{dof}"`: it {where} `{hung.part.called}`',
            help="put it into a body of its own in the part: it is laid out by that",
        )


def _warn(linking: Linking, part: Part, element: Node, what: str, help: str) -> None:
    message = f"{element.tag}{after_noun(element.get('name'))} {what}"
    linking.sink.warning("world-frame", message, linking.span(part.unit, element), help=help)


def sections(linking: Linking) -> None:
    for part in linking.parts:
        for section in list(part.unit.root):
            tag = section.tag
            if tag == "extension":
                _extension(linking, part, section)
            elif tag in _APPENDED and next(section.iterchildren("*"), None) is not None:
                # MuJoCo reads several sections of one tag as one, so any of them can receive it.
                with explained(BRINGS):
                    target = linking.base.section(tag)
                elements = [*above(section, part.unit.header), *section]
                linking.base.origins.own_all(elements, part.unit.origins.owner(section, part.unit.file))
                journal.place_all(target, elements)


def _extension(linking: Linking, part: Part, section: Node) -> None:
    with explained(BRINGS):
        target = linking.base.section("extension")
    known = {element.get("plugin"): element for element in linking.base.root.iterfind("extension/plugin")}
    for plugin in list(section.iterchildren("*")):
        existing = known.get(plugin.get("plugin"))
        if existing is None:
            journal.place(target, plugin)
            linking.base.origins.own(plugin, part.unit.file)
            known[plugin.get("plugin")] = plugin
            continue
        for instance in list(plugin):
            journal.place(existing, instance)
            linking.base.origins.own(instance, part.unit.file)
