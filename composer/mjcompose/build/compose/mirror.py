"""Step: a part has the pose of another part, reflected, and its keyframes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import Any

from lxml import etree

from mjcompose.base.diagnostic import Path
from mjcompose.build.plan.plan import AttachPart, Plan, part_name
from mjcompose.link.linking import Part
from mjcompose.link.numbers import text
from mjcompose.link.unit_keys import VECTORS, KeyNotes, bare_model, keys_of, remove_keys
from mjcompose.mujoco import engine
from mjcompose.sources.context import Context
from mjcompose.text.node import locate
from mjcompose.tree.unit import Unit


def mirror_places(plan: Plan, parts: Sequence[Part]) -> None:
    """Let parts have the place of the part that they mirror, unless they have their own."""
    by_name = {part_name(step, plan.separator): part for step, part in zip(plan.parts, parts, strict=True)}
    for step, part in zip(plan.parts, parts, strict=True):
        mirror = step.attachment.mirror
        if mirror is None or (other := by_name.get(mirror.of)) is None:
            continue
        part.mirrors, part.across = other, mirror.axes
        written = dict.fromkeys(("pos", "quat"), locate(plan.document, (*step.at, "mirror"), key=True))
        place = part.place if step.attachment.place[1] else other.place
        part.place = replace(place, offset={}, written=written, computed="mirror")


def mirror_keys(
    plan: Plan, units: Sequence[Unit | None], context: Context, session: engine.Session | None, notes: KeyNotes
) -> None:
    """Give parts the keyframes of the part that they mirror. Report parts that are no mirror images."""
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

        with ExitStack() as stack:
            asked = {"texts": [each.text for each in models if each], "axis": mirror.axes[1]}
            answer = engine.call(session or stack.enter_context(engine.Session()), mirrored_keys, [], argument=asked)
        if not answer.ok or "fault" in answer.value:
            fault = answer.value["fault"] if answer.ok else {"why": "crash", "error": answer.error}
            keys = [str(key.get("name") or "") for key in keys_of(other)]
            _report(plan, step, fault, keys=keys, context=context, at=at)
            continue
        span = locate(plan.document, at, key=True)
        remove_keys(unit)
        unit.part_keys = {}
        section = unit.section("keyframe")
        for key, rows in zip(keys_of(other), answer.value["keys"], strict=True):
            kept = {name: str(key.get(name)) for name in ("name", "time") if key.get(name)}
            kept |= {vector: text(rows[vector]) for vector in VECTORS if key.get(vector)}
            unit.origins.own(etree.SubElement(section, "key", kept), span)
        notes.note_source(unit)


def _report(
    plan: Plan, step: AttachPart, fault: Mapping[str, Any], keys: Sequence[str], context: Context, at: Path
) -> None:
    assert step.attachment.mirror is not None
    of, own, why = step.attachment.mirror.of, part_name(step, plan.separator), fault["why"]
    key = fault.get("key")
    where = "the reference configuration" if key is None else f"the keyframe `{keys[key]}`"
    name = fault.get("name")
    if why == "names":
        has, lacks = (own, of) if fault["mine"] else (of, own)
        what = f"`{has}` has the {fault['kind']} `{name}`, and `{lacks}` has no counterpart of that name"
    elif why == "body":
        what = f"in {where}, the body `{name}` is {1000 * fault['distance']:.3g} mm from its mirror image"
    elif why == "axis":
        what = f"the axis of the joint `{name}` is not reflected"
    elif why == "range":
        what = f"the range of the joint `{name}` is not reflected"
    elif why == "equality":
        what = f"in {where}, an equality constraint is not met"
    elif why == "force":
        what = f"in {where}, the actuators do not push the joint `{name}` like its mirror image"
    else:
        what = f"MuJoCo fails: {fault['error']}"
    message = f"`{own}` is not a mirror image of `{of}`: {what}"
    help = "remove `keys: true`, and write the keyframes of this part yourself"
    context.sink.error("mirror", message, locate(plan.document, at), help=help, subjects=(own,))
