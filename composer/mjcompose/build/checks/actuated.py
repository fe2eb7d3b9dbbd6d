"""The check `actuated`: every joint has an actuator."""

from __future__ import annotations

from typing import Any

import numpy as np

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, failed, unmet

_SHOWN = 8


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report joints without an actuator."""
    for key in ("joints", "exclude"):
        if (nothing := unmet(scope, ("joint",), asked[key], key)) is not None:
            return [nothing]
    mujoco, model = scope.mujoco, scope.model
    moved = _moved(mujoco, model)
    excluded = {joint for glob in asked["exclude"] for joint in scope.matching("joint", glob)}
    single = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    meant = (
        [joint for glob in asked["joints"] for joint in scope.matching("joint", glob)]
        if asked["joints"]
        else [joint for joint in scope.own("joint") if int(model.jnt_type[joint]) in single]
    )
    meant = [joint for joint in dict.fromkeys(meant) if joint not in excluded]
    without = [scope.called("joint", joint) for joint in meant if joint not in moved]
    scope.found("joints", len(meant))
    if not without:
        return []
    more = without[1:_SHOWN] + ([f"and {len(without) - _SHOWN} more"] if len(without) > _SHOWN else [])
    message = f"{without[0]} has no actuator"
    return [failed(message, f"{len(meant)} joints moved", f"{len(meant) - len(without)}", more=more)]


def _moved(mujoco: Any, model: Any) -> set[int]:
    """Return the joints that an actuator moves in the reference configuration, directly or through an equality."""
    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    dofs = set(np.asarray(data.moment_colind[: int(np.sum(data.moment_rownnz))]).tolist())
    moved = {int(model.dof_jntid[dof]) for dof in dofs}
    coupled = [
        (int(model.eq_obj1id[each]), int(model.eq_obj2id[each]))
        for each in range(model.neq)
        if int(model.eq_type[each]) == int(mujoco.mjtEq.mjEQ_JOINT) and int(model.eq_obj2id[each]) >= 0
    ]
    for _ in coupled:
        for one, other in coupled:
            if one in moved or other in moved:
                moved |= {one, other}
    return moved
