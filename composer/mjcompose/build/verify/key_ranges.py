"""Warn of implausible numbers: keys outside the ranges of the compiled model, servos stiffer than any drive."""

from __future__ import annotations

import math
from itertools import chain
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.build.plan.plan import Plan
from mjcompose.language.keyframe import CTRL, HOLD
from mjcompose.mujoco.index import Index, Ranged, ranged
from mjcompose.text.expression import Angle
from mjcompose.text.node import locate
from mjcompose.tree.classes import text_in_effect
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.language.keyframe import Keyframe

_STIFFEST = 1e6
"""In N·m/rad. A stiff industrial drive has some 1e5; no model of MuJoCo Menagerie has more than that."""
_SHOWN = 8
_KINDS = {"qpos": "joint", "ctrl": "actuator", "act": "actuator"}


def check_key_ranges(plan: Plan, model: Unit, index: Index, sink: Sink) -> None:
    """Warn of out-of-range values in the recipe's own keys, without the keys of parts."""
    if not plan.keyframes:
        return
    written = {str(key.get("name")): key for key in model.root.iterfind("keyframe/key")}
    for step in plan.keyframes:
        element = written.get(step.key.name)
        if element is None:
            continue
        rows = {vector: [float(each) for each in str(element.get(vector) or "").split()] for vector in _KINDS}
        found: dict[tuple[str, str], list[Ranged]] = {}
        for each in ranged(index, rows):
            found.setdefault((each.vector, _name(index, each)), []).append(each)
        for vector in _KINDS:
            for name in _written_names(step.key, vector, index):
                for each in found.get((vector, name), ()):
                    if not each.is_within():
                        _report(plan, model, step.key, entry=(vector, name), bound=each, sink=sink)


def _name(index: Index, each: Ranged) -> str:
    """Return the name in keys of a joint or an actuator; an unnamed joint has its body's name."""
    if each.kind == "actuator":
        return index.actuators[each.number].name
    joint = index.joints[each.number]
    is_taken = any(joint.body == other.name for other in index.joints)
    return joint.name or ("" if is_taken else joint.body)


def check_stiffness(model: Unit, index: Index, at: Span, sink: Sink) -> None:
    """Warn of servos that are stiffer at their joints than any drive: mostly a `kp` that a gear multiplies twice."""
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


def _written_names(key: Keyframe, vector: str, index: Index) -> list[str]:
    """Return the names for which the recipe sets a value in a vector; with `hold`, also all actuators."""
    names = [*key.values.get(vector, {})]
    if vector != CTRL:
        return names
    if key.controls.hold is not None:
        names += [each.name for each in index.actuators if each.name]
    return list(dict.fromkeys([*names, *(path[0] for path in key.controls.held if len(path) == 1)]))


def _report(plan: Plan, model: Unit, key: Keyframe, entry: tuple[str, str], bound: Ranged, sink: Sink) -> None:
    (vector, name), (low, high) = entry, bound.range
    kind = _KINDS[vector]
    holder, unit = _element(model.root, kind, name), bound.unit or ""
    if vector == "act" and holder is not None:
        dynamics = text_in_effect(holder, kind_of(holder), "dyntype", classes=model.classes)
        if holder.tag == "intvelocity" or dynamics == "integrator":
            unit = unit.removesuffix("/s")
    in_degrees = unit.startswith("rad") and _in_degrees(plan, key, entry)
    named = (unit.replace("rad", "deg") if in_degrees else unit) if unit != "1" else ""
    value, least, most = (
        f"{math.degrees(number) if in_degrees else number:.6g} {named}".rstrip() for number in (bound.value, low, high)
    )
    message = f"`{vector}` of `{name}` is {value}, outside of its range from {least} to {most}"
    notes = () if holder is None else (Note(f"the {kind}", model.origins.span(holder, model.file)),)
    span = locate(plan.document, (*key.at, *entry))
    sink.warning("out-of-range", message, span, notes=notes, help=_instead(key, entry, bound))


def _instead(key: Keyframe, entry: tuple[str, str], bound: Ranged) -> str | None:
    """Return advice on a control that holds the key's pose, or None if the recipe writes the number itself."""
    vector, name = entry
    if vector != CTRL or key.controls.hold is None or name in key.values.get(CTRL, {}):
        return None
    nearest = min(max(bound.value, bound.range[0]), bound.range[1])
    unit = "rad" if bound.unit == "rad" else ""
    way = f"{HOLD}: {key.controls.hold}"
    return f"change the pose, or write the control itself: `{CTRL}: {{{way}, {name}: {nearest:g}{unit}}}`"


def _in_degrees(plan: Plan, key: Keyframe, entry: tuple[str, str]) -> bool:
    """Return whether the recipe gives this entry in degrees."""
    values = key.values.get(entry[0], {}).get(entry[1], ())
    angles = [each.unit for each in values if isinstance(each, Angle)]
    return angles[0] == "deg" if angles else plan.angle_context.at((*key.at, *entry)).angle == "degree"


def _element(root: Node, kind: str, name: str) -> Node | None:
    if kind == "actuator":
        return next((each for each in root.iterfind("actuator/*") if each.get("name") == name), None)
    joints = [each for body in root.iterfind("worldbody") for each in body.iter("joint", "freejoint")]
    named = (each for each in joints if each.get("name") == name)
    unnamed = ((next(each.iterancestors("body"), None), each) for each in joints if not each.get("name"))
    return next(chain(named, (each for body, each in unnamed if body is not None and body.get("name") == name)), None)
