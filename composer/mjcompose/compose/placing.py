"""Steps: derive the place of a part from its mirror image, or as a scattered copy.

MuJoCo finds places for copies on a model in which they are free bodies. A mirror image may take the keyframes of its
original.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from contextlib import nullcontext
from dataclasses import replace
from itertools import groupby
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Path, Span
from mjcompose.base.rotation import Pose
from mjcompose.base.suggest import unknown_name
from mjcompose.base.words import number_text
from mjcompose.compose.load import FINISHED, keep_finished
from mjcompose.link.numbers import text
from mjcompose.link.unit_keys import VECTORS, KeyNotes, bare_model, keys_of, remove_keys
from mjcompose.mujoco import engine
from mjcompose.plan.plan import AttachPart, Plan, part_name
from mjcompose.plan.steps import DrawValues, EditElements, SetCollisions, Step, WriteKeyframe
from mjcompose.sources.context import Context
from mjcompose.text.node import locate
from mjcompose.tree import journal
from mjcompose.tree.unit import KeyRecord, KeySource, Number, Unit, numbers_of


def mirror_keys(
    plan: Plan, units: Sequence[Unit | None], context: Context, session: engine.Session | None, notes: KeyNotes
) -> None:
    """Give parts the keyframes of the part that they mirror. Report parts that are not mirror images."""
    by_name = {part_name(step, plan.separator): unit for step, unit in zip(plan.parts, units, strict=True)}
    for step, unit in zip(plan.parts, units, strict=True):
        mirror = step.attachment.mirror
        other = by_name.get(mirror.of) if mirror is not None and mirror.keys else None
        if mirror is None or other is None or unit is None:
            continue
        models = [bare_model(each) for each in (other, unit)]
        at = (*step.at, "mirror", "keys")
        if None in models:
            message = f"the keyframes of `{mirror.of}` cannot be mirrored: MuJoCo attaches a model in it"
            context.sink.error("not-supported", message, locate(plan.document, at), help="remove `keys: true`")
            continue
        from mjcompose.mujoco.mirror import mirrored_keys  # imports numpy

        with nullcontext(session) if session else engine.Session() as own:
            asked = {"texts": [each.text for each in models if each], "axis": mirror.axes[1]}
            answer = engine.call(own, mirrored_keys, [], argument=asked)
        if not answer.ok or "fault" in answer.value:
            fault = answer.value["fault"] if answer.ok else {"why": "crash", "error": answer.error}
            keys = [str(key.get("name") or "") for key in keys_of(other)]
            _report_mirror(plan, step, fault, keys=keys, context=context, at=at)
            continue
        span = locate(plan.document, at, key=True)
        remove_keys(unit.root)
        unit.part_keys = {}
        section = unit.section("keyframe")
        for key, rows in zip(keys_of(other), answer.value["keys"], strict=True):
            kept = {name: str(key.get(name)) for name in ("name", "time") if key.get(name)}
            kept |= {vector: text(rows[vector]) for vector in VECTORS if key.get(vector)}
            twin = section.makeelement("key", kept)
            journal.place(section, twin)
            unit.origins.own(twin, span)
            _carry_holds(other, key, unit, twin, span)
        notes.note_source(unit)


def _carry_holds(other: Unit, key: Node, unit: Unit, twin: Node, span: Span) -> None:
    """Note which numbers of a mirrored key hold its pose, so they are computed on the whole model."""
    if [each.get("name") for each in other.root.iterfind("actuator/*")] != [
        each.get("name") for each in unit.root.iterfind("actuator/*")
    ]:
        return
    rows: dict[str, list[Number]] = {}
    for vector in ("ctrl", "act"):
        before = numbers_of(other.origins.keys.get(key), key, vector)
        if any(number.source.hold for number in before):
            now = zip(str(twin.get(vector)).split(), before, strict=True)
            as_read = KeySource("key", vector, twin)
            rows[vector] = [
                Number(text, replace(old.source, span=span) if old.source.hold else as_read, at)
                for at, (text, old) in enumerate(now)
            ]
    if rows:
        unit.origins.keys[twin] = KeyRecord(numbers=rows)


def _report_mirror(
    plan: Plan, step: AttachPart, fault: Mapping[str, Any], keys: Sequence[str], context: Context, at: Path
) -> None:
    assert step.attachment.mirror is not None
    of = step.attachment.mirror.of
    own = part_name(step, plan.separator)
    why = fault["why"]
    key = fault.get("key")
    name = fault.get("name")
    where = "the reference configuration" if key is None else f"the keyframe `{keys[key]}`"
    has, lacks = (own, of) if fault.get("mine") else (of, own)
    what = {
        "names": f"`{has}` has the {fault.get('kind')} `{name}`, and `{lacks}` has no counterpart of that name",
        "body": f"in {where}, the body `{name}` is {1000 * fault.get('distance', 0):.3g} mm from its mirror image",
        "axis": f"the axis of the joint `{name}` is not reflected",
        "range": f"the range of the joint `{name}` is not reflected",
        "equality": f"in {where}, an equality constraint is not met",
        "force": f"in {where}, the actuators do not push the joint `{name}` like its mirror image",
        "crash": f"MuJoCo fails: {fault.get('error')}",
    }[why]
    message = f"`{own}` is not a mirror image of `{of}`: {what}"
    help = "remove `keys: true`, and write the keyframes of this part yourself"
    context.sink.error("mirror", message, locate(plan.document, at), help=help, subjects=(own,))


_APART = 100.0
"""The distance in meters between the copies before they are placed."""


def with_free_copies(plan: Plan) -> Plan:
    """Return the plan in which scattered copies are free bodies far apart, with the steps that affect their places."""
    waiting = [step for step in plan.parts if step.waits]
    if not waiting:
        return plan
    away = _places_apart(waiting)
    parts = [replace(step, moved=away[step.prefix], floats=True) if step.waits else step for step in plan.parts]
    keys = {step.attachment.scatter.key for step in waiting if step.attachment.scatter is not None}
    return replace(plan, parts=tuple(parts), steps=tuple(step for step in plan.steps if _counts(step, keys)))


def _places_apart(waiting: Sequence[AttachPart]) -> dict[str, Pose]:
    return {step.prefix: Pose((0.0, 0.0, _APART * (1 + number))) for number, step in enumerate(waiting)}


def scattered(
    plan: Plan, preview: Callable[[Plan], Unit | None], context: Context, session: engine.Session | None
) -> Plan | None:
    """Return the plan with a pose for each scattered copy, or None. `preview` joins a plan with free copies."""
    waiting = [step for step in plan.parts if step.waits]
    away = _places_apart(waiting)
    model = preview(with_free_copies(plan))
    if model is None:
        return None
    groups = [list(copies) for _, copies in groupby(waiting, key=lambda step: step.at)]
    compiler = model.section("compiler")
    for name in ("boundmass", "boundinertia"):  # a free body needs a mass
        if not compiler.get(name):
            journal.write(compiler, name, "1e-9")
    with nullcontext(session) if session else engine.Session() as own:
        if not keep_finished(model, context, own):
            return None
        from mjcompose.mujoco.scatter import scatter  # imports numpy

        answer = engine.call(own, scatter, [FINISHED], argument={"groups": [_asked(plan, group) for group in groups]})
    if not answer.ok:
        context.sink.error("mujoco-crash", f"MuJoCo fails on the copies: {answer.error}", groups[0][0].span)
        return None
    if "fault" in answer.value:
        _report_scatter(plan, groups[answer.value["fault"]["group"]], answer.value["fault"], context=context)
        return None
    moved: dict[str, Pose] = {}
    for group, poses, began in zip(groups, answer.value["poses"], answer.value["began"], strict=True):
        for step, pose, start in zip(group, poses, began, strict=True):
            moved[step.prefix] = (away[step.prefix] @ _pose(start).inverse() @ _pose(pose)).rounded()
    parts = tuple(replace(step, moved=moved[step.prefix]) if step.waits else step for step in plan.parts)
    return replace(plan, parts=parts)


def _counts(step: Step, keys: Set[str | None]) -> bool:
    """Return whether a step can affect the places of copies, which have a free joint until they are placed."""
    if isinstance(step, WriteKeyframe):
        return step.key.name in keys
    if isinstance(step, SetCollisions):
        return bool(step.collisions.sides)
    selector = step.edit.select if isinstance(step, EditElements) else None
    selector = step.field.select if isinstance(step, DrawValues) else selector
    return selector is None or selector.tag not in ("joint", "freejoint")


def _asked(plan: Plan, group: list[AttachPart]) -> dict[str, Any]:
    attachment = group[0].attachment
    scatter = attachment.scatter
    assert scatter is not None
    return {
        "bodies": [step.prefix for step in group],
        "over": scatter.over.named,
        "place": attachment.place,
        "part": str(group[0].at[-1]),
        "clearance": scatter.clearance,
        "upright": scatter.upright,
        "seed": scatter.seed,
        "key": scatter.key,
        "settle": scatter.settle,
    }


def _pose(numbers: list[list[float]]) -> Pose:
    (x, y, z), (a, b, c, d) = numbers
    return Pose((x, y, z), (a, b, c, d))


def _report_scatter(plan: Plan, group: list[AttachPart], fault: dict[str, Any], context: Context) -> None:
    scatter = group[0].attachment.scatter
    assert scatter is not None
    at = (*group[0].at, "replicate", 0, "scatter")
    why = fault["why"]
    _, over = scatter.over.named
    part = f"`{group[0].at[-1]}`"
    count = len(group)
    copies = f"{count} {'copy' if count == 1 else 'copies'} of {part}"
    notes: tuple[Note, ...] = ()
    where = "count"
    code = "scatter"
    if why == "unknown":
        where = "key" if fault["kind"] == "keyframe" else "over"
        span = locate(plan.document, (*at, where, *((fault["kind"],) if where == "over" else ())))
        context.sink.add(unknown_name(fault["kind"], fault["name"], fault["known"], span=span))
        return
    if why == "room":
        from mjcompose.mujoco.scatter import COPY, EDGE  # imports numpy

        width, depth = (number_text(float(f"{100 * each:.4g}")) for each in fault["room"][:2])
        apart = f" with {number_text(100 * scatter.clearance)} cm between them" if scatter.clearance else ""
        message = f"{copies} do not fit on `{over}` ({width} × {depth} cm){apart}: {fault['placed']} did"
        words = {EDGE: f"not completely on `{over}`", COPY: "too close to another copy"}
        tried = [f"{number:,} {words.get(what, f'too close to `{what}`')}" for what, number in fault["blocked"][:4]]
        notes = (Note(f"places that were tried: {', '.join(tried)}"),)
        smaller = f"`count: {fault['placed']}`" if fault["placed"] else "a larger surface"
        help = f"write {smaller}" + (", or a smaller `clearance`" if scatter.clearance else "")
    elif why == "moves":
        where = "key"
        message = f"`{over}` or the place of {part} can move, so `scatter` cannot use the keyframe `{scatter.key}`"
        help = "remove `key`: the copies are placed in the reference configuration"
    elif why == "untouchable":
        message = f"the copies of {part} cannot be kept apart: in MuJoCo, they do not collide with one another"
        help = "give their geoms a common bit in `contype` and `conaffinity`, by `edit` in the part"
    elif why == "endless":
        where = "over"
        message = f"the plane `{over}` has no edges to scatter copies between"
        region = "{to: world, site: {name: region, type: box, size: [0.3, 0.2, 0.001]}}"
        help = f"add a region, `add: [{region}]`, and write `over: {{site: region}}`"
    elif why == "fell":
        where = "settle"
        message = f"{fault['fallen']} of {copies} fall off `{over}` while they settle"
        help = "choose a larger surface" if scatter.upright else "write `upright: true`, or choose a larger surface"
    elif why == "restless":
        where = "settle"
        message = f"the copies of {part} still move at {fault['speed']:.3g} m/s or rad/s after {scatter.settle:g} s"
        help = "write a longer `settle`"
    else:
        where = "settle"
        code = "unstable"
        message = f"the simulation of {copies} diverges"
        help = "see why by `mjcompose view` without `settle`"
    span = locate(plan.document, (*at, where), key=where != "count")
    context.sink.error(code, message, span, notes=notes, help=help, subjects=(str(group[0].at[-1]),))
