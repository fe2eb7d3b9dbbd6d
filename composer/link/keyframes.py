"""The keys of all parts, laid out anew for the finished model: values go with their joints, actuators and bodies.

`layouts` runs while the units are still apart; `keyframes` when nothing more will be added to the model.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link import numbers
from composer.link.angles import model_angle
from composer.link.layout import BLOCK, Layout, Slot, Unknown, lay_out
from composer.link.linking import Linking, Part
from composer.link.measured import is_measured, widths
from composer.link.placing import pose_in_world, read_pose
from composer.pose import Pose, normalise, rotate
from composer.tree.classes import ORIENTATIONS, childclass_of
from composer.tree.line import line_of
from composer.tree.unit import Unit

_LAST_LINE = 65535  # that lxml lets be set
VECTORS = ("qpos", "qvel", "act", "ctrl", "mpos", "mquat")
_IDENTITY = {"free": ("0 0 0 1 0 0 0".split()), "ball": "1 0 0 0".split()}


@dataclass(slots=True)
class _Key:
    """A key of the result: numbers, as text, for each vector and element that some part says something about."""

    name: str
    time: str | None
    element: Node
    unit: Unit
    values: dict[str, dict[Node, list[str]]] = field(default_factory=dict)


def layouts(linking: Linking) -> None:
    """Note how each unit lays out its keys, while it is still by itself."""
    for unit in linking.units if linking.parts else ():
        _write_padding(unit)
    keeping = [part for part in linking.parts if part.keyframes != "none" and keys_of(part.unit)]
    if not keeping and not keys_of(linking.base):
        return
    linking.base_layout = layout_of(linking, linking.base)
    for part in linking.parts:
        part.layout = layout_of(linking, part.unit)


def keyframes(linking: Linking) -> None:
    """Write every key once, complete for the finished model."""
    if linking.base_layout is None:
        return
    keys: dict[str, _Key] = {}
    _collect(linking, linking.base, linking.base_layout, None, keys)
    for part in linking.parts:
        if part.keyframes != "none" and part.layout is not None:
            _collect(linking, part.unit, part.layout, part, keys)
        if part.layout is not None:
            _carry_references(linking, part, part.layout)
    root = linking.base.root
    final = _final_layout(linking)
    if final is None:
        return
    old = [key for section in root.iterchildren("keyframe") for key in section.iterchildren("key")]
    if not linking.parts and _same(final, linking.base_layout):
        return
    _check_kept(linking, keys.values())
    for key in old:
        section = key.getparent()
        assert section is not None
        section.remove(key)
    target = linking.base.section("keyframe")
    reference = _Reference(linking)
    for merged in keys.values():
        element = root.makeelement("key")
        if merged.name:
            element.set("name", merged.name)
        if merged.time is not None:
            element.set("time", merged.time)
        for vector in VECTORS:
            if vector in merged.values:
                row = reference.row(vector, final, merged.values[vector])
                if row:
                    element.set(vector, " ".join(row))
        target.append(element)
        linking.base.origins.own(element, merged.unit.origins.owner(merged.element, merged.unit.file))
        line = line_of(merged.element)
        if line is not None and line <= _LAST_LINE:
            element.sourceline = line  # type: ignore[assignment]  # the stubs know it as read alone


def _check_kept(linking: Linking, keys: Iterable[_Key]) -> None:
    """Tell what a key says that cannot be laid out anew."""
    keeping = [linking.base, *(part.unit for part in linking.parts if part.keyframes != "none")]
    for unit in keeping:
        for key in keys_of(unit):
            if key.get("plastic"):
                linking.sink.error(
                    "not-supported",
                    f"`plastic` of {_called(key)} cannot be carried over yet",
                    linking.span(unit, key, "plastic"),
                    help="leave the keys out: `keyframes: none`",
                )
    if any("mpos" in key.values or "mquat" in key.values for key in keys):
        for replicate in linking.base.root.iter("replicate"):
            if any(body.get("mocap") == "true" for body in replicate.iter("body")):
                _not_laid_out(linking, linking.base, Unknown(replicate))


def keys_of(unit: Unit) -> list[Node]:
    """The `<key>` elements of a unit."""
    return [key for section in unit.root.iterchildren("keyframe") for key in section.iterchildren("key")]


def _write_padding(unit: Unit) -> None:
    """`<size nkey>` pads with default keys: as written keys they stay with the part that asks for them."""
    for size in unit.root.iterchildren("size"):
        count = int(str(size.attrib.pop("nkey", "-1")))
        for _ in range(len(keys_of(unit)), count):
            unit.section("keyframe").append(unit.root.makeelement("key"))


def layout_of(linking: Linking, unit: Unit) -> Layout | None:
    """How a unit by itself lays out its keys, with MuJoCo's help where that is needed; None where it is told."""
    try:
        layout = lay_out(unit, {})
    except Unknown:
        return _measured_layout(linking, unit)
    if any(slot.free or slot.kind == BLOCK for slot in layout.joints.values()) and any(
        is_measured(unit, joint, slot) for joint, slot in layout.joints.items()
    ):
        return _measured_layout(linking, unit)
    return layout


def _measured_layout(linking: Linking, unit: Unit) -> Layout | None:
    """Ask MuJoCo for the widths and references that the tree does not tell."""
    known = widths(linking, unit)
    if known is None:
        return None
    linking.measured.update(known)
    try:
        return lay_out(unit, known)
    except Unknown as unknown:
        _not_laid_out(linking, unit, unknown)
        return None


def _final_layout(linking: Linking) -> Layout | None:
    try:
        return lay_out(linking.base, {**linking.measured, **_slots(linking)})
    except Unknown as unknown:
        _not_laid_out(linking, linking.base, unknown)
        return None


def _slots(linking: Linking) -> dict[Node, Slot]:
    """What the units already knew of their joints and actuators."""
    found = [linking.base_layout, *(part.layout for part in linking.parts)]
    known: dict[Node, Slot] = {}
    for layout in found:
        if layout is not None:
            known |= layout.joints | layout.actuators
    return known


def _not_laid_out(linking: Linking, unit: Unit, unknown: Unknown) -> None:
    tag = unknown.element.tag
    linking.sink.error(
        "not-supported",
        f"keyframes of a model with this `<{tag}>` cannot be laid out: only MuJoCo knows its size",
        linking.span(unit, unknown.element),
        help="leave the keys out: `keyframes: none`",
    )


def _same(final: Layout, before: Layout) -> bool:
    return (
        list(final.joints) == list(before.joints)
        and list(final.actuators) == list(before.actuators)
        and final.mocaps == before.mocaps
    )


def _collect(linking: Linking, unit: Unit, layout: Layout, part: Part | None, keys: dict[str, _Key]) -> None:
    for number, element in enumerate(keys_of(unit)):
        own = str(element.get("name") or "")
        name = own if part is None or part.keyframes == "merge" or not own else part.prefix + own
        time = element.get("time")
        slot_key = name or f"\0{id(element)}{number}"
        key = keys.get(slot_key)
        if key is None:
            key = keys[slot_key] = _Key(name, time, element, unit)
        elif time is not None and key.time is not None and numbers.read(time) != numbers.read(key.time):
            _times_differ(linking, unit, element, key)
        elif key.time is None:
            key.time = time
        for vector in VECTORS:
            text = str(element.get(vector) or "").split()
            if text:
                _take(linking, unit, layout, part, element, key, vector, text)


def _take(
    linking: Linking,
    unit: Unit,
    layout: Layout,
    part: Part | None,
    element: Node,
    key: _Key,
    vector: str,
    text: list[str],
) -> None:
    columns = cut_row(linking, unit, layout, element, vector, text)
    if columns is None:
        return
    if part is not None:
        if vector in ("qpos", "qvel"):
            _check_flexes(linking, part, layout, element, vector, columns)
        _carry(part, layout, vector, columns)
    key.values.setdefault(vector, {}).update(columns)


def cut_row(
    linking: Linking, unit: Unit, layout: Layout, element: Node, vector: str, text: list[str]
) -> dict[Node, list[str]] | None:
    """The numbers of one vector of a key by joint, actuator or body; short rows give fewer, wrong ones are told."""
    owners = holders(layout, vector)
    total = sum([width for _, width in owners])
    if len(text) > total:
        linking.sink.error(
            "keyframe-conflict",
            f"`{vector}` of {_called(element)} has {len(text)} numbers, and `{unit.file}` has room for {total}",
            linking.span(unit, element, vector),
        )
        return None
    taken: dict[Node, list[str]] = {}
    at = 0
    for holder, width in owners:
        if at + width > len(text):
            if at < len(text) and vector not in ("mpos", "mquat"):  # MuJoCo ignores half a pose there
                linking.sink.error(
                    "keyframe-conflict",
                    f"`{vector}` of {_called(element)} ends in the middle of a joint, "
                    f"after {len(text)} of {total} numbers",
                    linking.span(unit, element, vector),
                )
            break
        taken[holder] = text[at : at + width]
        at += width
    return taken


def _check_flexes(
    linking: Linking, part: Part, layout: Layout, key: Node, vector: str, taken: Mapping[Node, object]
) -> None:
    """The bodies of a flex do not turn with the frames above it, so that its numbers mean other directions there."""
    for block, slot in layout.joints.items():
        if slot.kind == BLOCK and block in taken and block.tag == "flexcomp" and _is_turned(part, block):
            linking.sink.error(
                "not-supported",
                f"`{vector}` of {_called(key)} has the vertices of a flex, which `{part.called}` turns",
                linking.span(part.unit, key, vector),
                notes=(Note("the flex", linking.span(part.unit, block)),),
                help="leave the keys out, `keyframes: none`, or put the `<flexcomp>` into a body",
            )


def _is_turned(part: Part, flex: Node) -> bool:
    """Whether the place of the part turns a flex at its root."""
    own, node = True, flex.getparent()
    while node is not None and node.tag == "frame":
        own = own and node.get("childclass") != part.top_class
        if not own and any(node.get(name) for name in ORIENTATIONS):
            return True
        node = node.getparent()
    return False


def _called(key: Node) -> str:
    return f"the key `{key.get('name')}`" if key.get("name") else "a key without a name"


def holders(layout: Layout, vector: str) -> list[tuple[Node, int]]:
    """What the numbers of a vector belong to, in their order, each with how many are its own."""
    if vector in ("qpos", "qvel"):
        return [(joint, slot.widths[vector == "qvel"]) for joint, slot in layout.joints.items()]
    if vector in ("ctrl", "act"):
        return [(actuator, slot.widths[vector == "act"]) for actuator, slot in layout.actuators.items()]
    return [(body, 3 if vector == "mpos" else 4) for body in layout.mocaps]


def _carry(part: Part, layout: Layout, vector: str, taken: dict[Node, list[str]]) -> None:
    """Free joints and mocap bodies say where they are in the world: they move with the part."""
    moved = part.pose_in_world
    if moved is None or moved.is_identity:
        return
    if vector in ("qpos", "qvel"):
        for joint, slot in layout.joints.items():
            if slot.free and joint in taken:
                taken[joint] = _carried(moved, slot, vector, taken[joint])
    elif vector in ("mpos", "mquat"):
        for body in layout.mocaps:
            values = taken.get(body)
            if values:
                x = numbers.read(" ".join(values))
                if vector == "mpos":
                    new: tuple[float, ...] = (moved @ Pose((x[0], x[1], x[2]))).pos
                else:
                    new = (moved @ Pose(quat=normalise(x))).quat
                taken[body] = numbers.text(new).split()


def _carried(moved: Pose, slot: Slot, vector: str, values: list[str]) -> list[str]:
    """The numbers of a joint or a block, with every free joint in it moved."""
    values = list(values)
    for at_qpos, at_qvel in slot.free:
        if vector == "qvel":  # the linear part is in the world's frame, the angular in the body's own
            x, y, z = numbers.read(" ".join(values[at_qvel : at_qvel + 3]))
            values[at_qvel : at_qvel + 3] = numbers.text(rotate(moved.quat, (x, y, z))).split()
        else:
            x, y, z, w, a, b, c = numbers.read(" ".join(values[at_qpos : at_qpos + 7]))
            pose = moved @ Pose((x, y, z), normalise((w, a, b, c)))
            values[at_qpos : at_qpos + 7] = numbers.text([*pose.pos, *pose.quat]).split()
    return values


def _carry_references(linking: Linking, part: Part, layout: Layout) -> None:
    """What was measured of a part by itself moves with it."""
    moved = part.pose_in_world
    for joint, slot in layout.joints.items():
        if slot.free and moved is not None and joint in linking.references:
            linking.references[joint] = _carried(moved, slot, "qpos", linking.references[joint])


def _times_differ(linking: Linking, unit: Unit, element: Node, key: _Key) -> None:
    report = linking.sink.error if linking.conflict == "error" else linking.sink.warning
    report(
        "keyframe-conflict",
        f"the keys `{key.name}` of two parts have different times: {element.get('time')} and {key.time}",
        linking.span(unit, element, "time"),
        notes=(Note("the other one is here", linking.span(key.unit, key.element, "time")),),
        help="write `keyframes: prefix` in one of the parts to keep its keys apart",
    )


class _Reference:
    """The reference configuration of the finished model: what a key holds where no part says anything."""

    def __init__(self, linking: Linking) -> None:
        self.linking = linking
        self.sequence = linking.base.settings.eulerseq

    @cached_property
    def degrees(self) -> bool:
        return model_angle(self.linking) == "degree"

    @cached_property
    def class_refs(self) -> bool:
        return self.linking.base.classes.give("joint", "ref")

    def row(self, vector: str, layout: Layout, values: dict[Node, list[str]]) -> list[str]:
        row: list[str] = []
        if vector in ("mpos", "mquat"):
            for body in layout.mocaps:
                given = values.get(body)
                if given is None:
                    pose = self._pose(body)
                    given = numbers.text(pose.pos if vector == "mpos" else pose.quat).split()
                row += given
            return row
        second = vector in ("qvel", "act")
        for element, slot in (layout.joints if vector in ("qpos", "qvel") else layout.actuators).items():
            given = values.get(element)
            if given is None:
                given = self._qpos(element, slot) if vector == "qpos" else ["0"] * slot.widths[second]
            row += given
        return row

    def _qpos(self, joint: Node, slot: Slot) -> list[str]:
        measured = self.linking.references.get(joint)
        if measured is not None:
            return measured
        if slot.kind == "free":
            body = joint.getparent()
            while body is not None and body.tag != "body":
                body = body.getparent()
            if body is not None:
                pose = self._pose(body)
                return numbers.text([*pose.pos, *pose.quat]).split()
        if slot.kind == BLOCK:
            return ["0"] * slot.widths[0]
        if slot.kind == "ball":
            return _IDENTITY["ball"]
        ref = joint.get("ref")
        if ref is None and self.class_refs:
            ref = self.linking.base.classes.effective(joint, childclass_of(joint), "ref")
        if ref is None:
            return ["0"]
        value = numbers.read(ref)[0]
        if slot.kind == "hinge" and self.degrees:
            value = numbers.joint_radians(value)
        return numbers.text([value]).split()

    def _pose(self, body: Node) -> Pose:
        outer = body.getparent()
        inner = read_pose(body, self.degrees, self.sequence)
        return inner if outer is None else pose_in_world(outer, self.degrees, self.sequence) @ inner
