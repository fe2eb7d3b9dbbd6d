"""Rule `key-out-of-range`: in keyframes, positions and controls are within the ranges of joints and actuators."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, at_keys, keys_named
from mjcompose.build.checks.rules.rule import Rule, excepted, listed
from mjcompose.language.forms.scalars import Items, Name, NotNegative

if TYPE_CHECKING:
    from mjcompose.mujoco.index import Range


class KeyOutOfRange(Rule):
    """In keyframes, positions, controls and activations are within their ranges."""

    word: ClassVar = "key-out-of-range"
    kinds: ClassVar = ("joint", "actuator")
    instead: ClassVar = {"keys": "key"}

    key: Annotated[tuple[Annotated[str, Name("key", glob=True)], ...], Items(1, single=True)] = ()
    """which keyframes; without it, all of them"""
    margin: NotNegative = 0.0
    """how far they stay from both ends, in the unit of each range"""


RULE = KeyOutOfRange
_KINDS = KeyOutOfRange.kinds
_ROUNDING = 1e-6


def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
    """Report numbers of keys that are out of range."""
    keys, margin = keys_named(scope, settings["key"]), settings["margin"]
    if isinstance(keys, Fault):
        return [keys]
    ignored = excepted(scope, _KINDS, settings)
    if isinstance(ignored, Fault):
        return [ignored]
    outside: list[str] = []
    count = 0
    for name, data in at_keys(scope, keys):
        for kind, number, vector, value, (low, high), unit in _values(scope, data):
            if (kind, number) in ignored:
                continue
            count += 1
            if low + margin - _slack(low) <= value <= high - margin + _slack(high):
                continue
            of = scope.called(kind, number)
            outside.append(
                f"`{vector}` of {of} in `{name}` is {value:.6g}{unit}, and its range is from {low:.6g} to {high:.6g}"
            )
    scope.found("values", count)
    ends = f", {margin:g} from both ends" if margin else ""
    return listed(outside, f"all within their ranges{ends}", f"{len(outside)} outside")


def _slack(bound: float) -> float:
    """Return how far a number may be out of range: ranges are often rounded."""
    return _ROUNDING * max(1.0, abs(bound))


def _values(scope: Scope, data: Any) -> Iterator[tuple[str, int, str, float, Range, str]]:
    """Yield the numbers of a key that have a range and belong to the recipe.

    Each with the kind and id of its element, its vector, its range and their unit.
    """
    from mjcompose.mujoco.index import index

    model = scope.model
    for joint in scope.own("joint"):
        if not model.jnt_limited[joint]:
            continue
        kind, at = int(model.jnt_type[joint]), int(model.jnt_qposadr[joint])
        low, high = (float(each) for each in model.jnt_range[joint])
        if kind == int(scope.mujoco.mjtJoint.mjJNT_BALL):
            quat = data.qpos[at : at + 4]
            turned = 2 * math.atan2(math.hypot(*quat[1:]), abs(float(quat[0])))
            yield "joint", joint, "qpos", turned, (0.0, high), " rad"
        else:
            unit = " rad" if kind == int(scope.mujoco.mjtJoint.mjJNT_HINGE) else " m"
            yield "joint", joint, "qpos", float(data.qpos[at]), (low, high), unit
    for place, actuator in enumerate(index(model, scope.mujoco).actuators):
        if not scope.owns("actuator", place):
            continue
        controls = data.ctrl[actuator.ctrl_address : actuator.ctrl_address + actuator.ctrl_size]
        for value, bounds in zip(controls, actuator.ctrl_ranges, strict=False):
            if bounds is not None:
                yield "actuator", place, "ctrl", float(value), bounds, ""
        if actuator.act_size and actuator.act_range is not None:
            yield "actuator", place, "act", float(data.act[actuator.act_address]), actuator.act_range, ""
