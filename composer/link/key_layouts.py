"""The layout of the keys of the units and of the finished model, partly with MuJoCo's help.

`layouts` is a pass; it runs while the units are still separate.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import accumulate

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.layout import BLOCK, Holder, Layout, Slot, Unknown, lay_out
from composer.link.linking import Linking
from composer.link.measured import attached, is_measured, widths
from composer.link.multiplied import Copy, element_of
from composer.tree.key_number import KeyRecord, KeySource, Number, numbers_of, texts
from composer.tree.unit import Unit

VECTORS = ("qpos", "qvel", "act", "ctrl", "mpos", "mquat")


def layouts(linking: Linking) -> None:
    """Record the key layout of each unit before the units are joined.

    Keys that `nkey` asks for stay with their part when they are written:

    >>> from composer.link.example import after
    >>> part = '<size nkey="1"/>'
    >>> after(layouts, part)
    part: <size/>
    part: <keyframe><key/></keyframe>
    """
    for unit in linking.units if linking.parts else ():
        _write_padding(unit)
    for part in linking.parts:
        if part.keyframes != "none":
            linking.keys.attached += [
                (part, each)
                for each, slot in attached(linking, part.unit).items()
                if slot.keys and (slot.free or slot.mocaps)
            ]
    keeping = [part for part in linking.parts if part.keyframes != "none" and keys_of(part.unit)]
    if linking.request.requested_keys is None and not keeping and not keys_of(linking.base):
        return
    linking.keys.base_layout = layout_of(linking, linking.base)
    for part in linking.parts:
        part.layout = layout_of(linking, part.unit)


def keys_of(unit: Unit) -> list[Node]:
    """Return the `<key>` elements of a unit."""
    return unit.root.findall("keyframe/key")


def remove_keys(unit: Unit) -> None:
    """Remove all keyframes of a unit."""
    for section in list(unit.root.iterchildren("keyframe")):
        unit.root.remove(section)


def _write_padding(unit: Unit) -> None:
    """Write out the default keys that `<size nkey>` adds, so that they stay with the part that asks for them."""
    # MuJoCo 4.0 counts up to `nkey` in the whole model: `<size nkey="3"/>` and one key of a part would give three keys,
    # of which the padding would be nobody's.
    for size in unit.root.iterchildren("size"):
        count = int(str(size.attrib.pop("nkey", "-1")))
        for _ in range(len(keys_of(unit)), count):
            unit.section("keyframe").append(unit.root.makeelement("key"))


def layout_of(linking: Linking, unit: Unit) -> Layout | None:
    """Return the key layout of a unit alone, measured with MuJoCo if needed, or None after a reported error.

    Rows that end in the middle of a joint then end behind it.
    """
    layout = _layout_of(linking, unit)
    linking.keys.shapes |= {flex: _shape(flex) for flex in unit.root.iter("flexcomp")}
    if layout is not None:
        _complete_rows(linking, unit, layout)
    return layout


_SHAPING = ("type", "count", "dim", "dof", "rigid", "file", "mesh", "point", "element", "cellcount")


def reshaped_flexes(linking: Linking) -> set[Node]:
    """Return the flexes that edits give other vertices, so that their numbers in keys mean nothing any more."""
    shapes = linking.keys.shapes
    return {
        flex for flex in linking.base.root.iter("flexcomp") if _shape(flex) != shapes.get(flex, _shape(flex))
    }


def _shape(flex: Node) -> str:
    """Return as text what decides which vertices a flex has, and which of them move."""
    own = [f"{name}={flex.get(name)}" for name in _SHAPING if flex.get(name)]
    return " ".join([*own, *(str(sorted(pin.items())) for pin in flex.iterchildren("pin"))])


def _complete_rows(linking: Linking, unit: Unit, layout: Layout) -> None:
    """Complete short rows with the numbers that MuJoCo would use, which are measured."""
    # MuJoCo 4.0 fills `qpos` up from the reference configuration: `<key qpos="1"/>` with `<joint/><joint ref="30"/>`
    # becomes 1 0.5236.
    keys = keys_of(unit)
    for vector in ("qpos", "qvel", "act", "ctrl") if keys else ():
        rows = [str(key.get(vector) or "").split() for key in keys]
        if not any(rows) or all(len(row) in (0, layout.total(vector)) for row in rows):
            continue
        ends = list(accumulate(width for _, width in holders(layout, vector)))
        short = [
            at for at, row in enumerate(rows) if ends and 0 < len(row) < ends[-1] and len(row) not in ends
        ]
        array = f"key_{vector}"
        if not short or linking.measure is None or not (found := linking.measure(unit, (array,))):
            continue
        for at in short:
            start = max((end for end in ends if end < len(rows[at])), default=0)
            end = next(end for end in ends if end > len(rows[at]))
            whole = found[array][at * ends[-1] + start : at * ends[-1] + end]
            _complete(unit, keys[at], vector, start, numbers.text(whole).split())


def _complete(unit: Unit, key: Node, vector: str, start: int, whole: list[str]) -> None:
    """Complete the numbers of the joint within which a row ends, and record which numbers come from MuJoCo."""
    record = unit.origins.keys.get(key)
    written = numbers_of(record, key, vector)
    source = KeySource("mujoco", vector, key)
    row = written[:start]
    for at, text in enumerate(whole, start):
        is_own = at < len(written) and numbers.read(written[at].text) == numbers.read(text)
        row.append(written[at] if is_own else Number(text, source, at))
    key.set(vector, " ".join(texts(row)))
    record = record or KeyRecord()
    unit.origins.keys[key] = replace(record, numbers={**record.numbers, vector: row})


def _layout_of(linking: Linking, unit: Unit) -> Layout | None:
    try:
        layout = lay_out(unit, {})
    except Unknown:
        return _measured_layout(linking, unit)
    # A body that MuJoCo aligns starts elsewhere than its `pos` says: see `is_leaf` in `alignment.py`.
    if any(slot.free or slot.kind == BLOCK for slot in layout.joints.values()) and any(
        is_measured(unit, joint, slot) for joint, slot in layout.joints.items()
    ):
        return _measured_layout(linking, unit)
    if layout.actuators and next(unit.root.iter("replicate"), None) is not None:
        return _measured_layout(linking, unit)  # which actuators are multiplied is for MuJoCo to say
    if any(isinstance(holder, Copy) or holder.tag != "body" for holder in layout.mocaps):
        return _measured_layout(linking, unit)
    return layout


def _measured_layout(linking: Linking, unit: Unit) -> Layout | None:
    """Return a layout with the widths and references that only MuJoCo knows, or None after a reported error."""
    try:
        known = widths(linking, unit)
        if known is None:
            return None
        linking.keys.measured.update(known)
        return lay_out(unit, known)
    except Unknown as unknown:
        not_laid_out(linking, unit, unknown)
        return None


def final_layout(linking: Linking) -> Layout | None:
    """Return the key layout of the finished model, or None after a reported error."""
    known = {**linking.keys.measured, **_slots(linking)}
    for node in linking.keys.reshaped:
        known.pop(node, None)
        linking.keys.measured.pop(node, None)
    try:
        return lay_out(linking.base, known)
    except Unknown as unknown:
        return _measured_anew(linking, known, unknown)


def refer_anew(linking: Linking, layout: Layout) -> None:
    """Measure the references that only MuJoCo knows again if the recipe added some or may have changed them."""
    joints = (
        linking.keys.edited or joint not in linking.keys.references
        for joint, slot in layout.joints.items()
        if is_measured(linking.base, joint, slot)
    )
    mocaps = (
        linking.keys.edited or holder not in linking.keys.mocap_references
        for holder in layout.mocaps
        if isinstance(holder, Copy) or holder.tag != "body"
    )
    if any(joints) or any(mocaps):
        _measured_anew(linking, {}, None)


def _measured_anew(linking: Linking, known: Mapping[Node, Slot], unknown: Unknown | None) -> Layout | None:
    """Measure what the recipe has added or changed, on the finished model without its keys."""
    unit = linking.flat()
    # MuJoCo refuses keys whose rows do not fit the model any more.
    sections = list(unit.root.iterchildren("keyframe"))
    for section in sections:
        unit.root.remove(section)
    try:
        found = widths(linking, unit)
        return None if found is None else lay_out(linking.base, {**found, **known})
    except Unknown as still:
        not_laid_out(linking, linking.base, unknown or still)
        return None
    finally:
        for section in sections:
            unit.root.append(section)


def _slots(linking: Linking) -> dict[Node, Slot]:
    """Return what is already known about the joints and actuators of the units."""
    found = [linking.keys.base_layout, *(part.layout for part in linking.parts)]
    known: dict[Node, Slot] = {}
    for layout in found:
        if layout is not None:
            known |= {element_of(holder): slot for holder, slot in layout.actuators.items()}
            known |= {
                element_of(holder): slot
                for holder, slot in layout.joints.items()
                if not (isinstance(holder, Copy) and holder.twists)
            }
    return known


def not_laid_out(linking: Linking, unit: Unit, unknown: Unknown) -> None:
    """Report that the keys of a unit cannot be laid out."""
    tag = unknown.element.tag
    leave_out = "leave the keys out: `keyframes: none`"
    if linking.request.requested_keys is not None:
        leave_out += ", and no `keyframe` in the recipe"
    linking.sink.error(
        "not-supported",
        f"keyframes of a model with this `<{tag}>` cannot be laid out: only MuJoCo knows its size",
        linking.span(unit, unknown.element),
        help=leave_out,
    )


def holders(layout: Layout, vector: str) -> list[tuple[Holder, int]]:
    """Return the owners of the numbers in a vector, in order, each with its count of numbers."""
    if vector in ("qpos", "qvel"):
        return [(joint, slot.widths[vector == "qvel"]) for joint, slot in layout.joints.items()]
    if vector in ("ctrl", "act"):
        return [(actuator, slot.widths[vector == "act"]) for actuator, slot in layout.actuators.items()]
    return [(body, count * (3 if vector == "mpos" else 4)) for body, count in layout.mocaps.items()]
