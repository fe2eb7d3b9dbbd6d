"""Rule `key-out-of-range`: in keyframes, positions and controls are within the ranges of joints and actuators."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, at_keys, keys_named
from mjcompose.build.checks.rules.rule import Rule, excepted, listed
from mjcompose.language.forms.scalars import Items, Name, NotNegative


class KeyOutOfRange(Rule):
    """In keyframes, positions, controls and activations are within their ranges."""

    word: ClassVar = "key-out-of-range"
    kinds: ClassVar = ("joint", "actuator")
    instead: ClassVar = {"keys": "key"}

    key: Annotated[tuple[Annotated[str, Name("key", glob=True)], ...], Items(1, single=True)] = ()
    """the keyframes; by default all"""
    margin: NotNegative = 0.0
    """the smallest distance to both ends, in the unit of each range"""


RULE = KeyOutOfRange


def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
    """Report numbers of keys that are out of range."""
    from mjcompose.mujoco.index import index, ranged

    keys, margin = keys_named(scope, settings["key"]), settings["margin"]
    if isinstance(keys, Fault):
        return [keys]
    ignored = excepted(scope, KeyOutOfRange.kinds, settings)
    if isinstance(ignored, Fault):
        return [ignored]
    outside: list[str] = []
    count = 0
    compiled = index(scope.model, scope.mujoco)
    for name, data in at_keys(scope, keys):
        for each in ranged(compiled, {"qpos": data.qpos, "ctrl": data.ctrl, "act": data.act}):
            if (each.kind, each.number) in ignored or not scope.owns(each.kind, each.number):
                continue
            count += 1
            if not each.is_within(margin):
                (low, high), unit = each.range, f" {each.unit}" if each.kind == "joint" else ""
                outside.append(
                    f"`{each.vector}` of {scope.called(each.kind, each.number)} in `{name}` is {each.value:.6g}{unit},"
                    f" and its range is from {low:.6g} to {high:.6g}"
                )
    scope.found("values", count)
    ends = f", {margin:g} from both ends" if margin else ""
    return listed(outside, f"all within their ranges{ends}", f"{len(outside)} outside")
