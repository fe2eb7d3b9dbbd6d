"""Rule `joint-unactuated`: every joint is moved by an actuator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope
from mjcompose.build.checks.rules.rule import Rule, chosen, excepted, listed
from mjcompose.language.forms.scalars import Items, Name


class JointUnactuated(Rule):
    """An actuator moves every joint, directly or through a tendon or an equality."""

    word: ClassVar = "joint-unactuated"
    kinds: ClassVar = ("joint",)
    instead: ClassVar = {"joints": "joint"}

    joint: Annotated[tuple[Annotated[str, Name("joint", glob=True)], ...], Items(1, single=True)] = ()
    """the joints; by default all hinges and slides"""


RULE = JointUnactuated


def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
    """Report joints without an actuator."""
    mujoco, model = scope.mujoco, scope.model
    joints = chosen(scope, "joint", settings)
    if isinstance(joints, Fault):
        return [joints]
    if joints is None:
        single = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
        joints = [joint for joint in scope.own("joint") if int(model.jnt_type[joint]) in single]
    ignored = excepted(scope, ("joint",), settings)
    if isinstance(ignored, Fault):
        return [ignored]
    joints = [joint for joint in joints if ("joint", joint) not in ignored]
    moved = _moved(mujoco, model)
    without = [joint for joint in joints if joint not in moved]
    scope.found("joints", len(joints))
    lines = [f"{scope.called('joint', joint)} has no actuator" for joint in without]
    return listed(lines, f"{len(joints)} joints moved", f"{len(joints) - len(without)}")


def _moved(mujoco: Any, model: Any) -> set[int]:
    """Return the joints that an actuator moves in the reference configuration, directly or through an equality."""
    import numpy as np

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
