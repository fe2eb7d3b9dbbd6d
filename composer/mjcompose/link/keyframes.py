"""The keys of all parts, split by joint, and rewritten for the finished model after its last element is added."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import dropwhile, takewhile

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.base.rotation import Pose, normalize, rotate
from mjcompose.base.words import element_text
from mjcompose.link import numbers
from mjcompose.link.expansion import Copy
from mjcompose.link.key_layout import BLOCK, Holder, KeyLayout, Slot
from mjcompose.link.linking import Linking, Part, shown_name
from mjcompose.link.measure import KeyFiller
from mjcompose.link.unit_keys import VECTORS, final_layout, keys_of, measure_references_again, reshaped_flexes
from mjcompose.tree import journal
from mjcompose.tree.classes import ORIENTATIONS
from mjcompose.tree.journal import Why, because, explained
from mjcompose.tree.unit import (
    KeyRecord,
    KeyValues,
    Number,
    PartKeys,
    Unit,
    line_of,
    moved,
    numbers_of,
    set_line,
    texts,
)

BASE = "base"
"""The name of the base among the parts."""


def part_keys(linking: Linking) -> Mapping[str, PartKeys]:
    """Return the kept or used keys of the base, of each part and of the parts of nested recipes; cached."""
    if linking.keys.by_part is not None:
        return linking.keys.by_part
    found: dict[str, PartKeys] = {}
    requested = linking.request.requested_keys or frozenset()
    for part in (None, *linking.parts):
        path = BASE if part is None else part.path(linking.request.separator)
        policy = _policy(linking, part)
        unit = linking.base if part is None else part.unit
        layout = linking.keys.base_layout if part is None else linking.keys.layouts.get(part)
        if layout is None:
            continue
        if policy != "none" or path in requested:
            own = linking.keys.own[part] = tuple(_own_keys(linking, unit, layout, part=part))
            found[path] = PartKeys(1, own)
        for inner, (depth, keys) in unit.part_keys.items():
            below = f"{path}{linking.request.separator}{inner}"
            if policy != "none" or below in requested:
                found[below] = PartKeys(depth + 1, tuple(_moved(linking, part, layout, key=key) for key in keys))
        if part is not None:
            _carry_references(linking, part, layout)
    linking.keys.by_part = found
    return found


def _own_keys(linking: Linking, unit: Unit, layout: KeyLayout, part: Part | None) -> Iterator[KeyValues]:
    for element in keys_of(unit):
        record = unit.origins.keys.get(element)
        time = numbers_of(record, element, "time")
        key = KeyValues(
            str(element.get("name") or ""), time[0] if time else None, element, file=unit.file, origins=unit.origins
        )
        for vector in VECTORS:
            taken = cut_row(linking, unit, layout, element=element, vector=vector) if element.get(vector) else None
            if taken is not None:
                key.values[vector] = taken
        yield _moved(linking, part, layout, key=key)


def _moved(linking: Linking, part: Part | None, layout: KeyLayout, key: KeyValues) -> KeyValues:
    if part is None:
        return key
    values = {vector: dict(columns) for vector, columns in key.values.items()}
    for vector, columns in values.items():
        _check_copies_of_part(linking, part, layout, key=key, vector=vector)
        if vector in ("qpos", "qvel"):
            _check_flexes(linking, part, layout, key=key, vector=vector)
        _carry(linking, part, layout, vector, taken=columns)
    return replace(key, values=values)


def cut_row(
    linking: Linking, unit: Unit, layout: KeyLayout, element: Node, vector: str
) -> dict[Holder, list[Number]] | None:
    """Split one vector of a key by joint, actuator or body. Short rows give fewer numbers; wrong rows are reported."""
    row = numbers_of(unit.origins.keys.get(element), element, vector)
    owners = layout.holders(vector)
    total = sum([width for _, width in owners])
    # MuJoCo fills a short row up, and refuses a long one: "invalid qpos size, expected 1, got 2" in 4.0.
    what = f"`{vector}` of {called(element)}"
    if len(row) > total:
        message = f"{what} has {len(row)} numbers, and `{unit.file}` takes {total}"
        linking.sink.error("keyframe-conflict", message, linking.span(unit, element, vector))
        return None
    taken: dict[Holder, list[Number]] = {}
    at = 0
    for holder, width in owners:
        if at + width > len(row):
            if vector in ("mpos", "mquat"):  # MuJoCo ignores half a pose there
                one = 3 if vector == "mpos" else 4
                if whole := (len(row) - at) // one * one:
                    taken[holder] = row[at : at + whole]
            elif at < len(row) and linking.parts:
                # MuJoCo has not filled it up. A model alone keeps its keys as they are written.
                message = f"{what} ends in the middle of a joint, after {len(row)} of {total} numbers"
                linking.sink.error("keyframe-conflict", message, linking.span(unit, element, vector))
            break
        taken[holder] = row[at : at + width]
        at += width
    return taken


def _check_copies_of_part(linking: Linking, part: Part, layout: KeyLayout, key: KeyValues, vector: str) -> None:
    """Report poses in the world that a `<replicate>` around the part would move to several places."""
    taken = key.values[vector]
    attachment = linking.attachments.get(part)
    replicate = None if attachment is None else next(attachment.content.iterancestors("replicate"), None)
    if vector in ("qpos", "qvel"):
        floats = any(slot.free and joint in taken for joint, slot in layout.joints.items())
    else:
        floats = vector in ("mpos", "mquat") and bool(taken)
    if replicate is not None and floats:
        place = f"`{part.called}` is attached in a `<replicate>`, which makes several of each"
        message = f"`{vector}` of {called(key.element)} has poses in the world, and {place}"
        notes = (Note("the `<replicate>`", linking.span(linking.base, replicate)),)
        help = "omit the keys: `drop: [key]`"
        linking.sink.error("not-supported", message, key.span(vector), notes=notes, help=help, subjects=(part.called,))


def _check_flexes(linking: Linking, part: Part, layout: KeyLayout, key: KeyValues, vector: str) -> None:
    """Report key numbers of a flex whose bodies do not turn with the frames above it, which changes directions."""
    for block, slot in layout.joints.items():
        if isinstance(block, Copy) or slot.kind != BLOCK or block not in key.values[vector]:
            continue  # a `<flexcomp>` in a replicate is in a body
        if block.tag == "flexcomp" and _is_turned(linking.top_class(part.unit), block):
            message = f"`{vector}` of {called(key.element)} has the vertices of a flex, which `{part.called}` turns"
            help = "omit the keys, `drop: [key]`, or put the `<flexcomp>` into a body"
            notes = (Note("the flex", linking.span(part.unit, block)),)
            subjects = (part.called,)
            linking.sink.error("not-supported", message, key.span(vector), notes=notes, help=help, subjects=subjects)


def _is_turned(top_class: str, flex: Node) -> bool:
    """Return whether the place of the part with that top class turns a flex at its root."""
    frames = list(takewhile(lambda node: node.tag == "frame", flex.iterancestors()))
    above = dropwhile(lambda node: node.get("childclass") != top_class, frames)
    return any(node.get(name) for node in above for name in ORIENTATIONS)


def called(key: Node) -> str:
    return element_text("key", key.get("name"), definite=True)


def _carry(linking: Linking, part: Part, layout: KeyLayout, vector: str, taken: dict[Holder, list[Number]]) -> None:
    """Move the poses of free joints and mocap bodies, which are in world coordinates, with the part."""
    pose = linking.pose_in_world(part)
    if pose is None or pose.is_identity:
        return
    by = (part.called, part.span)
    if vector in ("qpos", "qvel"):
        for joint, slot in layout.joints.items():
            if slot.free and joint in taken:
                taken[joint] = moved(taken[joint], _carry_slot(pose, slot, vector, values=texts(taken[joint])), by)
    if vector in ("mpos", "mquat"):
        for body in layout.mocaps:
            if body in taken:
                now = _place_vector(pose, vector, numbers.read(" ".join(texts(taken[body]))))
                taken[body] = moved(taken[body], numbers.text(now).split(), by)


def _place_vector(pose: Pose, vector: str, values: Sequence[float]) -> list[float]:
    if vector == "mpos":
        rows = zip(*[iter(values)] * 3, strict=True)
        return [each for x, y, z in rows for each in (pose @ Pose((x, y, z))).pos]
    quats = zip(*[iter(values)] * 4, strict=True)
    return [each for quat in quats for each in (pose @ Pose(quat=normalize(quat))).quat]


def _carry_slot(place: Pose, slot: Slot, vector: str, values: list[str]) -> list[str]:
    """Return the numbers of a joint or a block, with every free joint in it moved."""
    values = list(values)
    for at_qpos, at_qvel in slot.free:
        if vector == "qvel":  # the linear part is in the world's frame, the angular in the body's own
            x, y, z = numbers.read(" ".join(values[at_qvel : at_qvel + 3]))
            values[at_qvel : at_qvel + 3] = numbers.text(rotate(place.quat, (x, y, z))).split()
        else:
            x, y, z, w, a, b, c = numbers.read(" ".join(values[at_qpos : at_qpos + 7]))
            # MuJoCo compiles `qpos="0 0 0 2 0 0 0"` to a unit quaternion, so a key may have any length here.
            pose = place @ Pose((x, y, z), normalize((w, a, b, c)))
            values[at_qpos : at_qpos + 7] = numbers.text([*pose.pos, *pose.quat]).split()
    return values


def _carry_references(linking: Linking, part: Part, layout: KeyLayout) -> None:
    pose = linking.pose_in_world(part)
    if pose is None:
        return
    for joint, slot in layout.joints.items():
        if slot.free and joint in linking.keys.references:
            linking.keys.references[joint] = _carry_slot(pose, slot, "qpos", values=linking.keys.references[joint])
    for body in layout.mocaps:
        if body in linking.keys.mocap_references:
            linking.keys.mocap_references[body] = [pose @ each for each in linking.keys.mocap_references[body]]


def keyframes(linking: Linking) -> None:
    """Write every key once, complete for the finished model. A key of the recipe has the recipe's values."""
    _check_attached(linking)
    if linking.keys.base_layout is None:
        return
    linking.base.part_keys = part_keys(linking)
    keys = _merged_keys(linking)
    final = linking.keys.final_layout = final_layout(linking)
    if final is None:
        return
    # The keys of a model alone stay as they are written.
    is_alone = linking.request.requested_keys is None and not linking.parts and not linking.keys.void_keys
    if is_alone and all(
        [*getattr(final, name).items()] == [*getattr(linking.keys.base_layout, name).items()]  # in the same order
        for name in ("joints", "actuators", "mocaps")
    ):
        return
    _check_kept(linking)
    for element in keys_of(linking.base):
        journal.remove(element)
    if keys:
        measure_references_again(linking, final)
    reference = KeyFiller(linking)
    for key in keys.values():
        with explained(_LAID_OUT):
            section = linking.base.section("keyframe")
        with explained(_why_written(key)):
            journal.place(section, _element(linking, key, final, reference=reference))


_LAID_OUT = because("laid out anew for the whole model")


def _why_written(key: KeyValues) -> Why:
    owner = key.origins.owner(key.element, key.file)
    count = 1 + len(key.others)
    if not isinstance(owner, str):
        place = owner if isinstance(owner, Span) else partial(owner, None)
        return because("written in the recipe, laid out for the whole model", place)
    if count > 1:
        return because(f"{count} keys of that name merged, laid out for the whole model")
    return _LAID_OUT


def _element(linking: Linking, key: KeyValues, final: KeyLayout, reference: KeyFiller) -> Node:
    element = linking.base.root.makeelement("key")
    if key.name:
        journal.write(element, "name", key.name)
    # Numbers that the recipe writes are newer than its edits. For those that it copies with `from`, see `keyframe.py`.
    is_newer = any(key is each for each in linking.keys.written)
    void = frozenset(reshaped_flexes(linking) | (set() if is_newer else linking.keys.void_keys))
    record = KeyRecord((key.element, *key.others), void=void)
    if key.time is not None:
        journal.write(element, "time", key.time.text)
        record.numbers["time"] = [key.time]
    # A row is written whole. MuJoCo 4.0 fills up a short one: of joints with `ref="1"` and `ref="2"`, `qpos="7"` means
    # 7 and the 2 degrees of the second, and a short `ctrl` ends in 0.
    for vector in VECTORS:
        if vector in key.values and (row := reference.row(vector, final, key.values[vector], void)):
            journal.write(element, vector, " ".join(texts(row)))
            record.numbers[vector] = row
    _check_copies(linking, key, reference)
    _warn_of_lost(linking, key, reference)
    linking.base.origins.keys[element] = record
    for source in (key.element, *key.others):
        journal.note_source(element, source, _LAID_OUT)
    linking.base.origins.own(element, key.origins.owner(key.element, key.file))
    set_line(element, line_of(key.element))
    return element


def _check_copies(linking: Linking, key: KeyValues, reference: KeyFiller) -> None:
    for vector, element in reference.disagreeing[:1]:
        name = f"`{element.get('name')}`" if element.get("name") else f"a `<{element.tag}>`"
        which = f"the copies of {name}, which an edit moves out of its `<replicate>`"
        message = f"`{vector}` of {called(key.element)} has different numbers for {which}"
        notes = (Note("it is written here", linking.span(linking.base, element)),)
        help = "omit the keys, `drop: [key]`, and write the key in the recipe"
        linking.sink.error("keyframe-conflict", message, key.span(vector), notes=notes, help=help)
    reference.disagreeing.clear()


def _warn_of_lost(linking: Linking, key: KeyValues, reference: KeyFiller) -> None:
    """Warn about numbers of a key that no longer fit, because an edit changed their count or the vertices of a flex."""
    for vector, element in dict.fromkeys(reference.lost):
        what = f"{element.tag if element.get('name') else f'`<{element.tag}>`'} {shown_name(element)}"
        which = f"`{vector}` of {called(key.element)}"
        message = f"{which} has numbers that no longer fit the {what}: an edit gives it others"
        span = linking.span(linking.base, element, "count" if element.tag == "flexcomp" else "type")
        notes = (Note("the key", key.span(vector)),)
        cause = Cause(f"numbers of {what}", which)
        help = "they become the reference configuration's, or 0. Write them in a key of the recipe"
        linking.sink.warning("keyframe-conflict", message, span, notes=notes, help=help, cause=cause)
    reference.lost.clear()


def _merged_keys(linking: Linking) -> dict[str, KeyValues]:
    """Return the keys of the base and the parts, with equal names joined, and the recipe's keys, which replace them."""
    written = {key.name: key for key in linking.keys.written}
    came: dict[str, KeyValues] = {}
    owners: dict[str, Part | None] = {}
    part_keys(linking)
    for part, key in [(part, key) for part, keys in linking.keys.own.items() for key in keys]:
        policy = _policy(linking, part)
        if policy == "none":
            continue
        name = part.prefix + key.name if part is not None and policy == "prefix" and key.name else key.name
        # Keys without a name stay apart: MuJoCo 4.0 reads `<key/><key/>` as two.
        slot = name or f"\0{len(came)}"
        earlier = came.get(slot)
        if earlier is None:
            values = {vector: dict(columns) for vector, columns in key.values.items()}
            came[slot] = replace(key, name=name, values=values)
            owners[slot] = part
            continue
        if name not in written and "prefix" in (_policy(linking, owners[slot]), policy):
            _report_same_name(linking, earlier, owners[slot], second=key, second_part=part)
        _merge_keys(linking, earlier, key, settled=name in written)
    linking.keys.replaced = {name: came[name] for name in written if name in came}
    return came | written


def lay_out_replaced(linking: Linking) -> list[Node]:
    """Return the source keys that the recipe replaces, as they would be without it. They are not in the model."""
    final = final_layout(linking) if linking.keys.replaced else None
    if final is None:
        return []
    reference = KeyFiller(linking)
    return [_element(linking, key, final, reference=reference) for key in linking.keys.replaced.values()]


def _policy(linking: Linking, part: Part | None) -> str:
    return linking.request.base_keyframes if part is None else part.keyframes


def _merge_keys(linking: Linking, key: KeyValues, other: KeyValues, *, settled: bool) -> None:
    """Add to a key the values of another key with the same name. The times of a `settled` key need not agree."""
    key.others += (other.element, *other.others)
    if key.time is None:
        key.time = other.time
    elif not settled and other.time is not None and numbers.read(other.time.text) != numbers.read(key.time.text):
        report = linking.sink.error if linking.request.conflict == "error" else linking.sink.warning
        here = other.span("time")
        there = key.span("time")
        message = f"the keys `{key.name}` of two parts have different times: {other.time.text} and {key.time.text}"
        help = "write `keys: prefix` in one of the parts to keep its keys apart"
        notes = (Note("the other one is here", there),)
        cause = Cause(f"times in {there.file} and {here.file}", f"the key `{key.name}`")
        report("keyframe-conflict", message, here, notes=notes, help=help, cause=cause)
    for vector, columns in other.values.items():
        key.values.setdefault(vector, {}).update(columns)


def _report_same_name(
    linking: Linking, first: KeyValues, its_part: Part | None, second: KeyValues, second_part: Part | None
) -> None:
    """Report two keys that would have the same name if at least one of them must not change."""
    rename = f"rename one of them: `edit: [{{select: {{key: {second.name}}}, rename: NAME}}]`"
    if _policy(linking, second_part) == "prefix":
        apart = second_part
        other = its_part
        help = rename if apart is not None and apart.prefix else "give the part a `prefix`, or " + rename
    else:
        apart = its_part
        other = second_part
        help = rename if apart is not None else "write `keys: prefix` at the part: the base has no prefix"
    owner, other_owner = ("the base" if part is None else f"`{part.called}`" for part in (apart, other))
    message = f"the key `{first.name}` of {owner} must stay separate, and {other_owner} has a key of that name, too"
    notes = (Note("the first one is here", first.span()),)
    linking.sink.error("keyframe-conflict", message, second.span(), notes=notes, help=help, subjects=(first.name,))


def _check_attached(linking: Linking) -> None:
    # They are in no tree: MuJoCo 4.0 makes a key `q/k` of the key `k` of a model that it attaches with the prefix `q/`.
    for part, attach in linking.keys.attached:
        pose = linking.pose_in_world(part)
        if pose is not None and not pose.is_identity:
            message = f"the model attached here has keys with poses of its free bodies, and `{part.called}` moves it"
            help = f"write `drop: [key]` for `{part.called}`, or attach that model in the recipe"
            span = linking.span(part.unit, attach)
            linking.sink.error("not-supported", message, span, help=help, subjects=(part.called,))


def _check_kept(linking: Linking) -> None:
    """Report attributes of keys that cannot be laid out again."""
    for part in (None, *linking.parts):
        unit = linking.base if part is None else part.unit
        if _policy(linking, part) != "none":
            for key in keys_of(unit):
                if key.get("plastic"):
                    message = f"`plastic` of {called(key)} cannot be carried over yet"
                    cause = Cause(f"plastic in {unit.file}", called(key))
                    span = linking.span(unit, key, "plastic")
                    linking.sink.error("not-supported", message, span, help="omit the keys: `drop: [key]`", cause=cause)
