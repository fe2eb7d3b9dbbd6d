"""The check `size`: sizes of mjModel."""

from __future__ import annotations

from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, failed
from mjcompose.mujoco.addresses import VECTORS, span
from mjcompose.mujoco.attributes import KINDS

_COUNTED = {kind.size: word for word, kind in KINDS.items() if word not in ("body", "key")}
_SUMMED = {size: (kind, vector) for vector, (kind, size) in VECTORS.items()}


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report each size that is not the expected one. Merged keyframes belong to no single recipe."""
    found: list[Fault] = []
    for size, expected in asked["counts"].items():
        actual = count(scope, size)
        if actual is not None:
            scope.found(size, actual)
        if actual is not None and actual != expected:
            found.append(
                failed(
                    f"`{size}` is {actual}, not {expected}", f"{size} {expected}", f"{size} {actual}", size
                )
            )
    return found


def count(scope: Scope, size: str) -> int | None:
    """Return a size of mjModel, counting the recipe's own elements; None if that is impossible."""
    model = scope.model
    if scope.whole:
        value = getattr(model, size, None)
        return scope.roster.count("actuator") if value is None and size == "nactuator" else value
    if size in _COUNTED:
        return len(list(scope.own(_COUNTED[size])))
    if size == "nbody":
        return 1 + len(list(scope.own("body")))  # every model has the world
    if size in _SUMMED:
        kind, vector = _SUMMED[size]
        return sum(len(span(model, vector, index)) for index in scope.own(kind))
    return None
