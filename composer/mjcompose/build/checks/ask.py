"""Run one check on a compiled model in the child process."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import Table
from mjcompose.build.checks import (
    actuated,
    budget,
    clear,
    collision,
    equal,
    exists,
    limits,
    mass,
    no_penetration,
    plausible,
    reachable,
    size,
    stable,
)
from mjcompose.build.checks.check import Scope, to_json
from mjcompose.model.pattern import BadPattern
from mjcompose.mujoco.attributes import Model

CHECKS: Table[Callable[[Scope, dict[str, Any]], list[Fault]]] = Table(
    "checks",
    {
        "size": size.check,
        "mass": mass.check,
        "exists": exists.check,
        "stable": stable.check,
        "no_penetration": no_penetration.check,
        "clear": clear.check,
        "collision": collision.check,
        "reachable": reachable.check,
        "limits": limits.check,
        "actuated": actuated.check,
        "plausible": plausible.check,
        "budget": budget.check,
        "equal": equal.check,
    },
    "check",
)


def ask(mujoco: Any, model: Model, question: dict[str, Any]) -> dict[str, Any]:
    """Return the failures and the values of a check as JSON data; runs under `mjcompose.mujoco.engine.call`.

    ``question`` has the `kind`, the arguments of the check under `asked`, and the fields of a `Scope` under
    `scope`.
    """
    scope = Scope(mujoco, model, **question["scope"])
    try:
        found = CHECKS[question["kind"]](scope, question["asked"])
    except BadPattern as bad:
        found = [Fault("selector", bad.message, help=bad.help)]
    return {"findings": list(map(to_json, found)), "values": scope.values}
