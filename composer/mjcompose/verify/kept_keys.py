"""Compare the keys of the compiled model with the keys in sources and recipes, and warn about implausible keys.

MuJoCo compiles each source alone in a bare form, which gives the name of the element for each number of its keys.
Poses in the world move with their part. Recipes give the other numbers, unless edits make them meaningless. The
linker's own layout of keys is not used here.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Path, Span
from mjcompose.base.report import with_rest
from mjcompose.base.rotation import Pose, normalize, rotate
from mjcompose.base.sink import Sink
from mjcompose.base.words import element_text
from mjcompose.compose.key_names import entries_by_name
from mjcompose.language.keyframe import CTRL, HOLD, JOINT, WAYS, Keyframe
from mjcompose.link.linking import WrittenKey
from mjcompose.link.unit_keys import MARK, VECTORS, BareModel, KeyNotes, Within, bare_model, keys_of
from mjcompose.mujoco import engine
from mjcompose.mujoco.compare import key_rows
from mjcompose.mujoco.index import CompiledIndex, Ranged, ranged
from mjcompose.plan.plan import Plan
from mjcompose.text.expression import Angle
from mjcompose.text.node import locate
from mjcompose.tree.classes import text_in_effect
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import Unit, numbers_of
from mjcompose.verify.compile import WHOLE

_CLOSE = 1e-9
_KINDS = {"qpos": "joint", "qvel": "joint", "act": "actuator", "ctrl": "actuator", "mpos": "body", "mquat": "body"}
_CALLED = {"joint": "joint", "actuator": "actuator", "body": "mocap body"}


class Value(NamedTuple):
    """The expected numbers of a key, and the place where they are written; empty if MuJoCo has computed them."""

    numbers: Sequence[float]
    within: Within
    span: Span | None


Own = tuple[Any, str, int]
"""A joint, actuator or mocap body: its element, its name in a flex, and its number in its body."""
Meant = dict[str, dict[Own, list[Value]]]
"""The values of a key, by vector. There are several values for an element that a replicate multiplies."""


def check_kept_keys(model: Unit, notes: KeyNotes, session: engine.Session, sink: Sink) -> None:
    """Report numbers of the compiled model's keys that differ from the sources and the recipe."""
    keys = keys_of(model)
    # There is no bare model if MuJoCo attaches a model, or reads a shape from a file.
    final = bare_model(model) if keys and (notes.written or notes.sources) else None
    if final is None:
        return
    sources = list(chain.from_iterable(notes.sources.values()))
    texts = list(dict.fromkeys(source.text for source in sources))
    held = _held_keys(keys, model, notes)
    forces = [{"key": at, **_held_addresses(keys[at], model)} for at in held]
    answer = _rows(model, {"texts": [*texts, final.text], "mark": MARK, "held": forces}, session, sink)
    if answer is None:
        return
    described = dict(zip(texts, answer["bare"], strict=False))  # the last answer is about `final`
    originals = {key: (source, described[source.text]) for source in sources for key in source.rows}
    meaning = _KeyMeanings(model, notes, originals)
    controls = {at: row["ctrl"] for at, row in zip(held, answer["held"], strict=True)}
    comparison = _Comparison(final, answer, notes)
    for at, key in enumerate(keys):
        meant = meaning.of(key)
        if meant is not None:
            computed = _computed_controls(held[at]) if at in held else {}
            wrong = comparison.differences(meant, answer["keys"][at], computed, controls=controls.get(at))
            _report(key, list(wrong), model, sink=sink)


def _rows(model: Unit, question: Mapping[str, Any], session: engine.Session, sink: Sink) -> Mapping[str, Any] | None:
    """Return MuJoCo's numbers of the keys of the model and of the bare models, or report why there are none."""
    answer = engine.call(session, key_rows, [WHOLE], argument=question)
    if answer.ok and "unlike" not in answer.value:
        rows: Mapping[str, Any] = answer.value
        return rows
    why = answer.value["unlike"] if answer.ok else answer.error or answer.crash
    span = model.origins.span(keys_of(model)[0], model.file)
    sink.error("keyframe-wrong", f"the keys of the model cannot be checked: {why}", span)
    return None


def _held_keys(keys: Sequence[Node], model: Unit, notes: KeyNotes) -> dict[int, WrittenKey]:
    """Return the recipe's entries of the keys that hold a pose, by the number of the key."""
    held = {at: _held_key(key, model, notes) for at, key in enumerate(keys)}
    return {at: written for at, written in held.items() if written is not None}


def _computed_controls(written: WrittenKey) -> Mapping[Any, Span]:
    """Return the actuators whose controls MuJoCo computes to hold a pose: those that the recipe does not write."""
    controls = written.entries.get("ctrl", {})
    return {actuator: span for actuator, span in written.held.items() if actuator not in controls}


def _held_addresses(key: Node, model: Unit) -> dict[str, list[int]]:
    """Return the addresses of the controls that hold the pose of a key, by the way in which they hold it."""
    row = numbers_of(model.origins.keys.get(key), key, "ctrl")
    return {way: [at for at, number in enumerate(row) if number.source.hold == way] for way in WAYS}


def _held_places(key: Node, vector: str, model: Unit) -> set[int]:
    """Return the numbers of a mirrored key that hold its pose: MuJoCo computes them again on the whole model."""
    row = numbers_of(model.origins.keys.get(key), key, vector)
    return {at for at, number in enumerate(row) if number.source.hold}


def _held_key(key: Node, model: Unit, notes: KeyNotes) -> WrittenKey | None:
    """Return the recipe's entries of a key if it holds a pose."""
    record = model.origins.keys.get(key)
    written = notes.written.get(record.keys[0]) if record is not None and record.keys else None
    return written if written is not None and written.held else None


class _KeyMeanings(Struct, frozen=False):
    """Finds the meaning of a key from the keys and entries that form it."""

    model: Unit
    notes: KeyNotes
    sources: Mapping[Node, tuple[BareModel, Mapping[str, Any] | None]]

    def of(self, key: Node) -> Meant | None:
        """Return the meaning of a key; None if it is unknown, or edits have changed its numbers."""
        if key in self.notes.edited:
            return None
        written = self.notes.written.get(key)
        if written is not None:
            return self._written(written)
        if key in self.sources:
            source, described = self.sources[key]
            return None if described is None else self._read(source, described, key)
        record = self.model.origins.keys.get(key)
        return None if record is None or not record.keys else self._joined(record.keys, record.void)

    def _joined(self, keys: Sequence[Node], void: frozenset[Node]) -> Meant | None:
        found: Meant = {}
        for key in keys:
            meant = self.of(key)
            if meant is None:
                return None
            for vector, values in meant.items():
                found.setdefault(vector, {}).update({own: value for own, value in values.items() if own[0] not in void})
        return found

    def _written(self, written: WrittenKey) -> Meant | None:
        found = self._joined(written.taken, written.void)
        if found is not None:
            for node, span in written.held.items():  # of a nested recipe: this was compared with another model
                for vector in ("ctrl", "act"):
                    found.setdefault(vector, {})[node, "", 0] = [Value((), frozenset(), span)]
            for vector, entries in written.entries.items():
                values = found.setdefault(vector, {})
                for node, (numbers, span) in entries.items():
                    values[node, "", 0] = [Value(numbers, frozenset(), span)]
        return found

    def _read(self, source: BareModel, described: Mapping[str, Any], key: Node) -> Meant:
        """Return the meaning of a source's key, moved with its part."""
        found: Meant = {}
        at = list(source.rows).index(key)
        for vector, count in source.rows[key].items():
            row = described["keys"][at][vector]
            span = self.model.origins.span(key, source.file, vector)
            held = _held_places(key, vector, self.model)
            for name, body, number, start, stop in described["holders"][vector]:
                holder = source.holder(_KINDS[vector], name, body) if start < min(stop, count) else None
                if holder is None:
                    continue
                node, within = self.notes.origin(holder[0], holder[1])
                numbers = () if held & {*range(start, stop)} else _moved(row[start:stop], vector, source.moves)
                value = Value(numbers, within, span)
                found.setdefault(vector, {}).setdefault((node, holder[2], number if holder[2] else 0), []).append(value)
        return found


class _Difference(NamedTuple):
    """Numbers of a joint, actuator or mocap body that differ from the expected value."""

    vector: str
    name: str
    found: Sequence[float]
    meant: Value


class _Comparison(Struct):
    """Compares the keys of the `final` model with their meaning; `answer` is MuJoCo's answer about the bare models."""

    final: BareModel
    answer: Mapping[str, Any]
    notes: KeyNotes

    def differences(
        self,
        meant: Meant,
        row: Mapping[str, list[float]],
        computed: Mapping[Any, Span],
        *,
        controls: Sequence[float | None] | None,
    ) -> Iterator[_Difference]:
        """Yield the unexpected numbers of a key. `computed` has the controls that MuJoCo computed."""
        for vector in VECTORS:
            values = meant.get(vector, {})
            for name, body, number, start, stop in self.answer["bare"][-1]["holders"][vector]:
                found = row[vector][start:stop]
                holder = self.final.holder(_KINDS[vector], name, body)
                if holder is None or start == stop:
                    continue
                node, within = self.notes.origin(holder[0], holder[1])
                value: Value | None
                if node not in computed:
                    copies = values.get((node, holder[2], number if holder[2] else 0), [])
                    value = _value_of(copies, within, self.answer["reference"][vector][start:stop])
                elif vector == "ctrl" and controls is not None:
                    value = Value([each or 0.0 for each in controls[start:stop]], within, computed[node])
                else:
                    continue  # the activation of a filter or an integrator holds, too
                if value is not None and not _same(vector, found, value.numbers):
                    yield _Difference(vector, body if name.startswith(MARK) else name or body, found, meant=value)


def _value_of(copies: Sequence[Value], within: Within, default: Sequence[float]) -> Value | None:
    """Return the expected value of one copy of an element, or None if it is unknown."""
    inside = dict(within)
    alike = [each for each in copies if all(inside.get(r, n) == n for r, n in each.within)]
    if any(not each.numbers for each in alike):
        return None
    return next((each for each in alike if len(each.numbers) == len(default)), Value(default, within, None))


def _same(vector: str, one: Sequence[float], other: Sequence[float]) -> bool:
    a = _unit(vector, one)
    b = _unit(vector, other)
    ways = [b, [*b[:-4], *(-each for each in b[-4:])]] if _turns(vector, len(b)) else [b]
    return any(all(abs(x - y) <= _CLOSE * max(1.0, abs(y)) for x, y in zip(a, way, strict=True)) for way in ways)


def _turns(vector: str, width: int) -> bool:
    return vector == "mquat" or (vector == "qpos" and width in (4, 7))


def _unit(vector: str, numbers: Sequence[float]) -> list[float]:
    """Return the numbers with a normalized quaternion, as MuJoCo compiles it."""
    if not _turns(vector, len(numbers)) or not any(numbers[-4:]):
        return list(numbers)
    length = math.hypot(*numbers[-4:])
    return [*numbers[:-4], *(each / length for each in numbers[-4:])]


def _moved(numbers: Sequence[float], vector: str, poses: Sequence[Pose]) -> Sequence[float]:
    """Return a pose in the world, or a velocity there, after its part has been moved."""
    for pose in poses:
        if pose.is_identity:
            continue
        if vector == "qpos" and len(numbers) == 7:
            x, y, z, *quat = numbers
            there = pose @ Pose((x, y, z), normalize(tuple(quat)))
            numbers = [*there.pos, *there.quat]
        elif vector == "qvel" and len(numbers) == 6:
            numbers = [*rotate(pose.quat, tuple(numbers[:3])), *numbers[3:]]
        elif vector == "mpos":
            x, y, z = numbers
            numbers = (pose @ Pose((x, y, z))).pos
        elif vector == "mquat":
            numbers = (pose @ Pose(quat=normalize(tuple(numbers)))).quat
    return numbers


def _report(key: Node, wrong: Sequence[_Difference], model: Unit, sink: Sink) -> None:
    if not wrong:
        return
    called = element_text("key", key.get("name"), definite=True)
    first = wrong[0]
    notes = list(map(Note, with_rest([_sentence(each) for each in wrong], 4)[1:]))
    span = first.meant.span or model.origins.span(key, model.file, first.vector)
    sink.error(
        "keyframe-wrong",
        f"{_sentence(first)}, in {called} of the finished model",
        span,
        notes=notes,
        help="this is a fault of mjcompose: please report it",
        subjects=(str(key.get("name") or ""),),
    )


def _sentence(each: _Difference) -> str:
    found, meant = (" ".join(f"{number:.9g}" for number in row) for row in (each.found, each.meant.numbers))
    kind = _CALLED[_KINDS[each.vector]]
    return f"`{each.vector}` of the {kind} `{each.name}` is {found}, not {meant}"


_STIFFEST = 1e6
"""In N·m/rad. A stiff industrial drive has about 1e5; no model of MuJoCo Menagerie has more than that."""
_SHOWN = 8
_VECTOR_KINDS = {"qpos": "joint", "ctrl": "actuator", "act": "actuator"}


def check_key_ranges(plan: Plan, model: Unit, index: CompiledIndex, sink: Sink) -> None:
    """Warn about out-of-range values in the recipe's own keys, without the keys of parts."""
    if not plan.keyframes:
        return
    elements = {str(key.get("name")): key for key in model.root.iterfind("keyframe/key")}
    for step in plan.keyframes:
        element = elements.get(step.key.name)
        if element is None:
            continue
        rows = {vector: [float(word) for word in str(element.get(vector) or "").split()] for vector in _VECTOR_KINDS}
        outside: _Outside = {}
        for value in ranged(index, rows):
            of_element = outside.setdefault((value.vector, _name(index, value)), [])
            if not value.is_within():
                of_element.append(value)
        _warn_of_entries(plan, model, step.key, outside, sink=sink)
        _warn_of_controls_by_joint(plan, model, step.key, outside, index=index, sink=sink)


_Outside = dict[tuple[str, str], list[Ranged]]
"""The values of a key that are out of their ranges, by vector and name of the element; none for an element within."""


def _warn_of_entries(plan: Plan, model: Unit, key: Keyframe, outside: _Outside, *, sink: Sink) -> None:
    for vector in _VECTOR_KINDS:
        names = [name for kind, name in outside if kind == vector]
        for name, entry in _written_names(key, vector, names, plan.separator).items():
            for value in outside.get((vector, name), ()):
                _report_range(plan, model, key, entry=(vector, entry), name=name, bound=value, sink=sink)


def _warn_of_controls_by_joint(
    plan: Plan, model: Unit, key: Keyframe, outside: _Outside, *, index: CompiledIndex, sink: Sink
) -> None:
    driven = dict.fromkeys(joint for actuator in model.root.iterfind("actuator/*") for joint in _joints_of(actuator))
    for joint, (entry, *_) in entries_by_name(key.controls.joints, driven, plan.separator).items():
        for value in outside.get((CTRL, _only_actuator(model.root, joint)), ()):
            path = (*key.at, CTRL, JOINT, entry)
            _report_control_by_joint(plan, model, path, joint=joint, bound=value, index=index, sink=sink)


def _name(index: CompiledIndex, each: Ranged) -> str:
    """Return the name in keys of a joint or an actuator; an unnamed joint has its body's name."""
    if each.kind == "actuator":
        return index.actuators[each.number].name
    joint = index.joints[each.number]
    is_taken = any(joint.body == other.name for other in index.joints)
    return joint.name or ("" if is_taken else joint.body)


def check_stiffness(model: Unit, index: CompiledIndex, at: Span, sink: Sink) -> None:
    """Warn about servos stiffer at their joints than any drive, often because a gear multiplies `kp` twice."""
    stiff = [(number, each) for number, each in enumerate(index.actuators) if each.stiffness > _STIFFEST]
    if not stiff:
        return
    named = {str(each.get("name")): each for each in model.root.iterfind("actuator/*") if each.get("name")}
    # MuJoCo puts copies in a `<replicate>` behind the others; these and nameless ones have no place of their own.
    nodes = [named.get(each.name) for _, each in stiff]
    spans = [None if node is None else model.origins.span(node, model.file) for node in nodes]
    listed = ", ".join(f"`{each.name}`" if each.name else f"number {number}" for number, each in stiff[:_SHOWN])
    more = f" and {len(stiff) - _SHOWN} more" if len(stiff) > _SHOWN else ""
    subject = f"the actuator {listed} gives its joint"
    if len(stiff) > 1:
        subject = f"the actuators {listed}{more} give their joints up to"
    most = max(each.stiffness for _, each in stiff)
    span = next((span for span in spans if span is not None), at)
    help = "MuJoCo multiplies `kp` by the square of `gear`: divide `kp` by that, or set `gear` to 1"
    sink.warning("stiff-actuator", f"{subject} {most:.3g} N·m/rad, gear included", span, help=help)


def _written_names(key: Keyframe, vector: str, names: Collection[str], separator: str) -> dict[str, str]:
    """Return the names for which the recipe sets a value in a vector, with the entry; with `hold`, all actuators."""
    written = [*key.values.get(vector, {})]
    if vector == CTRL:
        written += [path[0] for path in key.controls.held if len(path) == 1]
    entries = {name: first for name, (first, *_) in entries_by_name(written, names, separator).items()}
    if vector == CTRL and key.controls.hold is not None:
        entries |= {name: name for name in names if name and name not in entries}
    return entries


def _report_range(
    plan: Plan, model: Unit, key: Keyframe, entry: tuple[str, str], name: str, bound: Ranged, sink: Sink
) -> None:
    vector, written = entry
    low, high = bound.range
    kind = _VECTOR_KINDS[vector]
    holder = _element(model.root, kind, name)
    unit = bound.unit or ""
    if vector == "act" and holder is not None:
        dynamics = text_in_effect(holder, kind_of(holder), "dyntype", classes=model.classes)
        if holder.tag == "intvelocity" or dynamics == "integrator":
            unit = unit.removesuffix("/s")
    angles = [each.unit for each in key.values.get(vector, {}).get(written, ()) if isinstance(each, Angle)]
    bare = plan.angle_context.at((*key.at, *entry)).angle == "degree"
    in_degrees = unit.startswith("rad") and (angles[0] == "deg" if angles else bare)
    named = (unit.replace("rad", "deg") if in_degrees else unit) if unit != "1" else ""
    value, least, most = (
        f"{math.degrees(number) if in_degrees else number:.6g} {named}".rstrip() for number in (bound.value, low, high)
    )
    message = f"`{vector}` of `{name}` is {value}, outside its range from {least} to {most}"
    notes = () if holder is None else (Note(f"the {kind}", model.origins.span(holder, model.file)),)
    span = locate(plan.document, (*key.at, *entry))
    sink.warning(
        "out-of-range", message, span, notes=notes, help=_instead(key, vector, name, written=written, bound=bound)
    )


def _joints_of(actuator: Node) -> list[str]:
    return [joint for end in ("joint", "jointinparent") if (joint := actuator.get(end))]


def _only_actuator(root: Node, joint: str) -> str:
    """Return the name of the actuator of a joint, or "" if there are several."""
    names = [str(each.get("name") or "") for each in root.iterfind("actuator/*") if joint in _joints_of(each)]
    return names[0] if len(names) == 1 else ""


def _report_control_by_joint(
    plan: Plan, model: Unit, path: Path, joint: str, bound: Ranged, index: CompiledIndex, sink: Sink
) -> None:
    name = _name(index, bound)
    holder = _element(model.root, "actuator", name)
    low, high = bound.range
    numbers = f"{bound.value:.6g}, outside its range from {low:.6g} to {high:.6g}"
    message = f"`{CTRL}` of `{name}`, which follows from the joint `{joint}`, is {numbers}"
    notes = () if holder is None else (Note("the actuator", model.origins.span(holder, model.file)),)
    sink.warning("out-of-range", message, locate(plan.document, path), notes=notes)


def _instead(key: Keyframe, vector: str, name: str, written: str, bound: Ranged) -> str | None:
    """Return advice on a control that holds the key's pose, or None if the recipe writes the number itself."""
    if vector != CTRL or key.controls.hold is None or written in key.values.get(CTRL, {}):
        return None
    nearest = min(max(bound.value, bound.range[0]), bound.range[1])
    unit = "rad" if bound.unit == "rad" else ""
    way = f"{HOLD}: {key.controls.hold}"
    return f"change the pose, or write the control itself: `{CTRL}: {{{way}, {name}: {nearest:g}{unit}}}`"


def _element(root: Node, kind: str, name: str) -> Node | None:
    if kind == "actuator":
        return next((each for each in root.iterfind("actuator/*") if each.get("name") == name), None)
    joints = [each for body in root.iterfind("worldbody") for each in body.iter("joint", "freejoint")]
    named = (each for each in joints if each.get("name") == name)
    unnamed = ((next(each.iterancestors("body"), None), each) for each in joints if not each.get("name"))
    return next(chain(named, (each for body, each in unnamed if body is not None and body.get("name") == name)), None)
