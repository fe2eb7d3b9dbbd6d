"""Run one check on a compiled model in the child process."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import Table
from mjcompose.build.checks.check import Scope, to_json
from mjcompose.language.check import MODULES
from mjcompose.mujoco.attributes import Model
from mjcompose.tree.pattern import BadPattern

CHECKS: Table[Callable[[Scope, dict[str, Any]], list[Fault]]] = Table("checks", {}, "check", modules=MODULES)


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
