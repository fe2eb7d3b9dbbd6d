"""The check `limits`: keys stay within the ranges of joints and actuators."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, at_keys, failed, keys_named, unmet
from mjcompose.mujoco.index import Index, Range, index

_ROUNDING = 1e-6
_SHOWN = 8
Value = tuple[str, int, str, float, Range, str]
"""A number of a key: kind and id of its element, its vector, the number, and its range and their unit."""


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report numbers of keys that are out of range."""
    keys = keys_named(scope, asked["keys"])
    if isinstance(keys, Fault):
        return [keys]
    if (nothing := unmet(scope, ("joint", "actuator"), asked["exclude"], "exclude")) is not None:
        return [nothing]
    names = {name for kind in ("joint", "actuator") for name in scope.names(kind)}
    excluded = {name for glob in asked["exclude"] for name in scope.fitting(glob, names)}
    outside: list[str] = []
    count = 0
    for name, data in at_keys(scope, keys):
        for kind, number, vector, value, (low, high), unit in _values(scope, data):
            if scope.written(kind, number) in excluded:
                continue
            count += 1
            bounds = low + asked["margin"], high - asked["margin"]
            if bounds[0] - _slack(low) <= value <= bounds[1] + _slack(high):
                continue
            of = scope.called(kind, number)
            outside.append(
                f"`{vector}` of {of} in `{name}` is {value:.6g}{unit}, and its range is from {low:.6g} to {high:.6g}"
            )
    scope.found("values", count)
    if not outside:
        return []
    more = outside[1:_SHOWN]
    if len(outside) > _SHOWN:
        more.append(f"and {len(outside) - _SHOWN} more numbers")
    margin = f", {asked['margin']:g} from both ends" if asked["margin"] else ""
    return [failed(outside[0], f"all within their ranges{margin}", f"{len(outside)} outside", more=more)]


def _slack(bound: float) -> float:
    """Return how far a number may be out of range: ranges are often rounded."""
    return _ROUNDING * max(1.0, abs(bound))


def _values(scope: Scope, data: Any) -> Iterator[Value]:
    """Yield the numbers of a key that have a range and belong to the recipe."""
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
    for place, actuator in enumerate(Index.from_data(index(model, scope.mujoco)).actuators):
        if not scope.owns("actuator", place):
            continue
        controls = data.ctrl[actuator.ctrl_address : actuator.ctrl_address + actuator.ctrl_size]
        for value, bounds in zip(controls, actuator.ctrl_ranges, strict=False):
            if bounds is not None:
                yield "actuator", place, "ctrl", float(value), bounds, ""
        if actuator.act_size and actuator.act_range is not None:
            yield "actuator", place, "act", float(data.act[actuator.act_address]), actuator.act_range, ""
