"""The check `stable`."""

from __future__ import annotations

from typing import Any

import numpy as np

from composer.compiled.addresses import span
from composer.compiled.joints import JOINT_TYPES
from composer.verify.kinds.finding import Finding, failed
from composer.verify.kinds.scope import SOLVED, Scope

_AT_THE_END = 0.1
"""The share of the time in which speeds are looked at."""
_DIVERGED = ("mjWARN_BADQPOS", "mjWARN_BADQVEL", "mjWARN_BADQACC")


def check(scope: Scope, asked: dict[str, Any]) -> list[Finding]:
    """The finding that the simulation diverges or does not come to rest, if so."""
    mujoco, model = scope.mujoco, scope.model
    data = scope.at_key(asked["key"])
    if isinstance(data, Finding):
        return [data]
    warnings = [int(getattr(mujoco.mjtWarning, name)) for name in _DIVERGED]
    limit, seconds = asked["max_speed"], asked["seconds"]
    steps = max(1, round(seconds / model.opt.timestep))
    dofs = np.flatnonzero([int(joint) in scope.joints for joint in model.dof_jntid])
    fastest, at, dof = 0.0, 0.0, -1
    first = steps - max(1, round(_AT_THE_END * steps))
    for step in range(steps):
        mujoco.mj_step(model, data)
        # MuJoCo resets what diverged, and is then at rest: its warnings tell.
        if any(data.warning[each].number for each in warnings):
            message = f"the simulation diverges after {(step + 1) * model.opt.timestep:.4g} s"
            return [
                failed(
                    message, f"at rest after {seconds:g} s", "not finite, or beyond all measure", "seconds"
                )
            ]
        if step >= first and len(dofs):
            speeds = np.abs(data.qvel[dofs])
            worst = int(speeds.argmax())
            if speeds[worst] > fastest:
                fastest, at, dof = float(speeds[worst]), float(data.time), int(dofs[worst])
    scope.found("speed", fastest, SOLVED)
    if fastest <= limit:
        return []
    joint = int(model.dof_jntid[dof])
    unit = _unit(model, dof, joint)
    message = f"{scope.called('joint', joint)} still moves at {fastest:.4g} {unit} after {at:.4g} s"
    return [failed(message, f"at most {limit:g} {unit}", f"{fastest:.4g} {unit}", "max_speed")]


def _unit(model: Any, dof: int, joint: int) -> str:
    """The unit of the velocity of one degree of freedom."""
    units = JOINT_TYPES[int(model.jnt_type[joint])].velocity_units
    return units[dof - span(model, "qvel", joint).start]
