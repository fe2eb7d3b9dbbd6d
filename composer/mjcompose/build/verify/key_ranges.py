"""Warn of numbers that no model means: keys outside the ranges of the compiled model, servos stiffer than anything."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.build.plan.plan import Plan
from mjcompose.language.keyframe import CTRL, HOLD
from mjcompose.model.classes import text_in_effect
from mjcompose.model.select import kind_of
from mjcompose.model.unit import Unit
from mjcompose.mujoco.arrays import BY_WORD
from mjcompose.mujoco.index import Actuator, Index, Joint, Range
from mjcompose.text.expression_values import Angle
from mjcompose.text.node import locate

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.language.keyframe import Keyframe

_ROUNDING = 1e-6
"""How far a value may be out of range, relative to the larger of 1 and the bound: ranges are often rounded."""
_STIFFEST = 1e6
"""In N·m/rad. A stiff industrial drive has some 1e5; no model of MuJoCo Menagerie has more than that."""
_SHOWN = 8
_KINDS = {"qpos": "joint", "ctrl": "actuator", "act": "actuator"}


class _Bound(NamedTuple):
    """A value and its range, and their unit in MuJoCo."""

    value: float
    range: Range
    unit: str | None


def check_key_ranges(plan: Plan, model: Unit, index: Index, sink: Sink) -> None:
    """Warn of out-of-range values in the recipe's own keys; keys that come from parts are not looked at."""
    if not plan.keyframes:
        return
    written = {str(key.get("name")): key for key in model.root.iterfind("keyframe/key")}
    ranges = _RangeCheck(plan, model, sink)
    for step in plan.keyframes:
        element = written.get(step.key.name)
        if element is None:
            continue
        for vector in _KINDS:
            row = [float(each) for each in str(element.get(vector) or "").split()]
            for name in _written_names(step.key, vector, index):
                for bound in _bounds(index, vector, name, row=row):
                    ranges.check(step.key, (vector, name), bound)


def check_stiffness(model: Unit, index: Index, at: Span, sink: Sink) -> None:
    """Warn of servos whose joints feel more than any drive is stiff: mostly a `kp` that a gear multiplies twice."""
    stiff = [(number, each) for number, each in enumerate(index.actuators) if each.stiffness > _STIFFEST]
    if not stiff:
        return
    named = {str(each.get("name")): each for each in model.root.iterfind("actuator/*") if each.get("name")}
    # MuJoCo puts copies in a `<replicate>` behind the others; these and nameless ones have no place of their own.
    nodes = [named.get(each.name) for _, each in stiff]
    spans = [None if node is None else model.origins.span(node, model.file) for node in nodes]
    listed = ", ".join(f"`{each.name}`" if each.name else f"number {number}" for number, each in stiff[:_SHOWN])
    more = f" and {len(stiff) - _SHOWN} more" if len(stiff) > _SHOWN else ""
    most = max(each.stiffness for _, each in stiff)
    what = (
        f"the actuator {listed} gives its joint"
        if len(stiff) == 1
        else f"the actuators {listed}{more} give their joints"
    )
    sink.warning(
        "stiff-actuator",
        f"{what} {'' if len(stiff) == 1 else 'up to '}{most:.3g} N·m/rad, gear included",
        next((span for span in spans if span is not None), at),
        help="MuJoCo multiplies `kp` by the square of `gear`: divide it by that, or set `gear` to 1",
    )


def _written_names(key: Keyframe, vector: str, index: Index) -> list[str]:
    """Return the names for which the recipe sets a value in a vector; with `hold`, also all actuators."""
    names = [*key.values.get(vector, {})]
    if vector != CTRL:
        return names
    if key.controls.hold is not None:
        names += [each.name for each in index.actuators if each.name]
    return list(dict.fromkeys([*names, *(path[0] for path in key.controls.held if len(path) == 1)]))


def _bounds(index: Index, vector: str, name: str, row: Sequence[float]) -> Iterator[_Bound]:
    """Yield the numbers of an entry that have a range."""
    if vector == "qpos":
        joint = _joint(index, name)
        if joint is None or not joint.limited:
            return
        values = row[joint.qpos_address : joint.qpos_address + joint.qpos_size]
        if joint.type == "ball" and values:  # its range limits the rotation angle about any axis
            angle = 2 * math.atan2(math.hypot(*values[1:]), abs(values[0]))
            yield _Bound(angle, (0.0, joint.range[1]), BY_WORD[joint.type].range_unit)
        elif values:
            yield _Bound(values[0], joint.range, BY_WORD[joint.type].range_unit)
        return
    actuator = next((each for each in index.actuators if each.name == name), None)
    if actuator is None:
        return
    for value, bounds in _of_actuator(actuator, vector, row):
        if bounds is not None:
            yield _Bound(value, bounds, actuator.unit if actuator.ctrl_size == 1 else None)


def _of_actuator(actuator: Actuator, vector: str, row: Sequence[float]) -> Iterator[tuple[float, Range | None]]:
    if vector == "ctrl":
        values = row[actuator.ctrl_address : actuator.ctrl_address + actuator.ctrl_size]
        yield from zip(values, actuator.ctrl_ranges, strict=False)
    elif actuator.act_size:
        yield row[actuator.act_address], actuator.act_range


def _joint(index: Index, name: str) -> Joint | None:
    """Return the joint of that name, else the unnamed joint in the body of that name."""
    named = (each for each in index.joints if each.name == name)
    return next(chain(named, (each for each in index.joints if not each.name and each.body == name)), None)


@dataclass(frozen=True, slots=True)
class _RangeCheck:
    plan: Plan
    model: Unit
    sink: Sink

    def check(self, key: Keyframe, entry: tuple[str, str], bound: _Bound) -> None:
        """Warn of a number of a key that is out of its range. `entry` is the vector and the name."""
        low, high = bound.range
        if _down(low) <= bound.value <= -_down(-high):
            return
        (vector, name), model = entry, self.model
        kind = _KINDS[vector]
        holder, unit = _element(model.root, kind, name), bound.unit or ""
        if vector == "act" and holder is not None and _integrates(holder, model):
            unit = unit.removesuffix("/s")
        in_degrees = unit.startswith("rad") and _in_degrees(self.plan, key, entry)
        named = (unit.replace("rad", "deg") if in_degrees else unit) if unit != "1" else ""
        value, least, most = (
            f"{math.degrees(number) if in_degrees else number:.6g} {named}".rstrip()
            for number in (bound.value, low, high)
        )
        self.sink.warning(
            "out-of-range",
            f"`{vector}` of `{name}` is {value}, outside of its range from {least} to {most}",
            locate(self.plan.document, (*key.at, *entry)),
            notes=() if holder is None else (Note(f"the {kind}", model.origins.span(holder, model.file)),),
            help=_instead(key, entry, bound),
        )


def _instead(key: Keyframe, entry: tuple[str, str], bound: _Bound) -> str | None:
    """Return advice on a control that holds the key's pose, or None if the recipe writes the number itself."""
    vector, name = entry
    if vector != CTRL or key.controls.hold is None or name in key.values.get(CTRL, {}):
        return None
    nearest = min(max(bound.value, bound.range[0]), bound.range[1])
    unit = "rad" if bound.unit == "rad" else ""
    way = f"{HOLD}: {key.controls.hold}"
    return f"change the pose, or write the control itself: `{CTRL}: {{{way}, {name}: {nearest:g}{unit}}}`"


def _down(bound: float) -> float:
    """Return a lower bound, lowered a little."""
    return bound - _ROUNDING * max(1.0, abs(bound))


def _in_degrees(plan: Plan, key: Keyframe, entry: tuple[str, str]) -> bool:
    """Return whether the recipe gives this entry in degrees."""
    vector, name = entry
    at = (*key.at, *entry)
    angles = [each for each in key.values.get(vector, {}).get(name, ()) if isinstance(each, Angle)]
    return angles[0].unit == "deg" if angles else plan.angle_context.at(at).angle == "degree"


def _integrates(actuator: Node, model: Unit) -> bool:
    """Return whether the actuator integrates its control into its activation."""
    dynamics = text_in_effect(actuator, kind_of(actuator), "dyntype", classes=model.classes)
    return actuator.tag == "intvelocity" or dynamics == "integrator"


def _element(root: Node, kind: str, name: str) -> Node | None:
    if kind == "actuator":
        return next((each for each in root.iterfind("actuator/*") if each.get("name") == name), None)
    joints = [each for body in root.iterfind("worldbody") for each in body.iter("joint", "freejoint")]
    named = (each for each in joints if each.get("name") == name)
    of_body = (
        each
        for each in joints
        if not each.get("name")
        and (body := next(each.iterancestors("body"), None)) is not None
        and body.get("name") == name
    )
    return next(chain(named, of_body), None)
