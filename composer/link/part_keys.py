"""The keys of every part, by the path of the part: the values for the part's own joints, actuators and mocap bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link import numbers
from composer.link.key_layouts import VECTORS, holders, keys_of
from composer.link.layout import BLOCK, Holder, Layout, Slot
from composer.link.linking import Linking
from composer.link.multiplied import Copy
from composer.link.part import Part
from composer.numerics.pose import Pose, normalise, rotate
from composer.tree.classes import ORIENTATIONS
from composer.tree.key import Key, PartKeys
from composer.tree.key_number import Number, moved, numbers_of, texts
from composer.tree.unit import Unit

BASE = "base"
"""What the base is called among the parts."""


def part_keys(linking: Linking) -> Mapping[str, PartKeys]:
    """Return the keys of the base, of each part, and of the parts of nested recipes. The result is cached.

    Of those that are left out only the ones that the recipe asks for. The poses of the parts must be known.
    """
    if linking.keys.by_part is not None:
        return linking.keys.by_part
    found: dict[str, PartKeys] = {}
    asked = linking.request.requested_keys or frozenset()
    for part in (None, *linking.parts):
        path = BASE if part is None else part.path(linking.request.separator)
        policy = linking.request.base_keyframes if part is None else part.keyframes
        unit, layout = (linking.base, linking.keys.base_layout) if part is None else (part.unit, part.layout)
        if layout is None:
            continue
        if policy != "none" or path in asked:
            own = linking.keys.own[part] = tuple(_own_keys(linking, unit, layout, part))
            found[path] = PartKeys(1, own)
        for inner, (depth, keys) in unit.part_keys.items():
            below = f"{path}{linking.request.separator}{inner}"
            if policy != "none" or below in asked:
                moved = tuple(_moved(linking, part, layout, key) for key in keys)
                found[below] = PartKeys(depth + 1, moved)
        if part is not None:
            _carry_references(linking, part, layout)
    linking.keys.by_part = found
    return found


def _own_keys(linking: Linking, unit: Unit, layout: Layout, part: Part | None) -> Iterator[Key]:
    for element in keys_of(unit):
        record = unit.origins.keys.get(element)
        time = numbers_of(record, element, "time")
        key = Key(str(element.get("name") or ""), time[0] if time else None, element, unit.file, unit.origins)
        for vector in VECTORS:
            taken = cut_row(linking, unit, layout, element, vector) if element.get(vector) else None
            if taken is not None:
                key.values[vector] = taken
        yield _moved(linking, part, layout, key)


def _moved(linking: Linking, part: Part | None, layout: Layout, key: Key) -> Key:
    """Return the key moved to the place of its part."""
    if part is None:
        return key
    values = {vector: dict(columns) for vector, columns in key.values.items()}
    for vector, columns in values.items():
        _check_copies(linking, part, layout, key, vector, columns)
        if vector in ("qpos", "qvel"):
            _check_flexes(linking, part, layout, key, vector, columns)
        _carry(part, layout, vector, columns)
    return replace(key, values=values)


def cut_row(
    linking: Linking, unit: Unit, layout: Layout, element: Node, vector: str
) -> dict[Holder, list[Number]] | None:
    """Split one vector of a key by joint, actuator or body. Short rows give fewer numbers; wrong ones are reported."""
    text = numbers_of(unit.origins.keys.get(element), element, vector)
    owners = holders(layout, vector)
    total = sum([width for _, width in owners])
    # MuJoCo fills a short row up, and refuses a long one: "invalid qpos size, expected 1, got 2" in 4.0.
    if len(text) > total:
        linking.sink.error(
            "keyframe-conflict",
            f"`{vector}` of {called(element)} has {len(text)} numbers, and `{unit.file}` has room for {total}",
            linking.span(unit, element, vector),
        )
        return None
    taken: dict[Holder, list[Number]] = {}
    at = 0
    for holder, width in owners:
        if at + width > len(text):
            if vector in ("mpos", "mquat"):  # MuJoCo ignores half a pose there
                one = 3 if vector == "mpos" else 4
                if whole := (len(text) - at) // one * one:
                    taken[holder] = text[at : at + whole]
            elif at < len(text) and linking.parts:
                # MuJoCo has not filled it up. A model alone keeps its keys as they are written.
                linking.sink.error(
                    "keyframe-conflict",
                    f"`{vector}` of {called(element)} ends in the middle of a joint, "
                    f"after {len(text)} of {total} numbers",
                    linking.span(unit, element, vector),
                )
            break
        taken[holder] = text[at : at + width]
        at += width
    return taken


def _check_copies(
    linking: Linking, part: Part, layout: Layout, key: Key, vector: str, taken: Mapping[Holder, object]
) -> None:
    """Report poses in the world that a `<replicate>` around the part would take to several places."""
    holder = part.content
    replicate = None if holder is None else next(holder.iterancestors("replicate"), None)
    floats = (
        any(slot.free and joint in taken for joint, slot in layout.joints.items())
        if vector in ("qpos", "qvel")
        else vector in ("mpos", "mquat") and bool(taken)
    )
    if replicate is not None and floats:
        linking.sink.error(
            "not-supported",
            f"`{vector}` of {called(key.element)} has poses in the world, and `{part.called}` is attached in a "
            "`<replicate>`, which makes several of each",
            key.span(vector),
            notes=(Note("the `<replicate>`", linking.span(linking.base, replicate)),),
            help="leave the keys out: `keyframes: none`",
            subjects=(part.called,),
        )


def _check_flexes(
    linking: Linking, part: Part, layout: Layout, key: Key, vector: str, taken: Mapping[Holder, object]
) -> None:
    """Report key numbers of a flex whose bodies do not turn with the frames above it, so that directions change."""
    for block, slot in layout.joints.items():
        if isinstance(block, Copy) or slot.kind != BLOCK or block not in taken:
            continue  # a `<flexcomp>` in a replicate is in a body
        if block.tag == "flexcomp" and _is_turned(part, block):
            linking.sink.error(
                "not-supported",
                f"`{vector}` of {called(key.element)} has the vertices of a flex, which `{part.called}` turns",
                key.span(vector),
                notes=(Note("the flex", linking.span(part.unit, block)),),
                help="leave the keys out, `keyframes: none`, or put the `<flexcomp>` into a body",
                subjects=(part.called,),
            )


def _is_turned(part: Part, flex: Node) -> bool:
    """Return whether the place of the part turns a flex at its root."""
    own, node = True, flex.getparent()
    while node is not None and node.tag == "frame":
        own = own and node.get("childclass") != part.top_class
        if not own and any(node.get(name) for name in ORIENTATIONS):
            return True
        node = node.getparent()
    return False


def called(key: Node) -> str:
    """Return the name of a key in messages."""
    return f"the key `{key.get('name')}`" if key.get("name") else "a key without a name"


def _carry(part: Part, layout: Layout, vector: str, taken: dict[Holder, list[Number]]) -> None:
    """Move the poses of free joints and mocap bodies, which are in world coordinates, with the part."""
    pose = part.pose_in_world
    if pose is None or pose.is_identity:
        return
    by = (part.called, part.span)
    if vector in ("qpos", "qvel"):
        for joint, slot in layout.joints.items():
            if slot.free and joint in taken:
                taken[joint] = moved(taken[joint], _carried(pose, slot, vector, texts(taken[joint])), by)
    elif vector in ("mpos", "mquat"):
        for body in layout.mocaps:
            if body in taken:
                now = _placed(pose, vector, numbers.read(" ".join(texts(taken[body]))))
                taken[body] = moved(taken[body], numbers.text(now).split(), by)


def _placed(pose: Pose, vector: str, values: Sequence[float]) -> list[float]:
    """Return the moved positions or orientations of mocap bodies."""
    if vector == "mpos":
        rows = zip(*[iter(values)] * 3, strict=True)
        return [each for x, y, z in rows for each in (pose @ Pose((x, y, z))).pos]
    quats = zip(*[iter(values)] * 4, strict=True)
    return [each for quat in quats for each in (pose @ Pose(quat=normalise(quat))).quat]


def _carried(place: Pose, slot: Slot, vector: str, values: list[str]) -> list[str]:
    """Return the numbers of a joint or a block, with every free joint in it moved."""
    values = list(values)
    for at_qpos, at_qvel in slot.free:
        if vector == "qvel":  # the linear part is in the world's frame, the angular in the body's own
            x, y, z = numbers.read(" ".join(values[at_qvel : at_qvel + 3]))
            values[at_qvel : at_qvel + 3] = numbers.text(rotate(place.quat, (x, y, z))).split()
        else:
            x, y, z, w, a, b, c = numbers.read(" ".join(values[at_qpos : at_qpos + 7]))
            # MuJoCo compiles `qpos="0 0 0 2 0 0 0"` to a unit quaternion, so that a key may have any length here.
            pose = place @ Pose((x, y, z), normalise((w, a, b, c)))
            values[at_qpos : at_qpos + 7] = numbers.text([*pose.pos, *pose.quat]).split()
    return values


def _carry_references(linking: Linking, part: Part, layout: Layout) -> None:
    """Move the measured references of a part with it."""
    pose = part.pose_in_world
    if pose is None:
        return
    for joint, slot in layout.joints.items():
        if slot.free and joint in linking.keys.references:
            linking.keys.references[joint] = _carried(pose, slot, "qpos", linking.keys.references[joint])
    for body in layout.mocaps:
        if body in linking.keys.mocap_references:
            linking.keys.mocap_references[body] = [
                pose @ each for each in linking.keys.mocap_references[body]
            ]
