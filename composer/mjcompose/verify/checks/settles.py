"""The check `settles`: a simulation from a keyframe comes to rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import Fault
from mjcompose.language.checks.settles import Near, Settles
from mjcompose.mujoco.arrays import JOINT_TYPES
from mjcompose.verify.checks.check import SOLVED, Scope, beside, failed

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_AT_THE_END = 0.1
"""The final share of the simulated time in which speeds are checked."""


def check(scope: Scope, settles: Settles) -> list[Fault]:
    """Report a simulation that diverges, or a joint that moves at its end or ends elsewhere."""
    import numpy as np

    from mjcompose.mujoco.controls import Divergence, steps_in

    mujoco = scope.mujoco
    model = scope.model
    data = scope.at_key(settles.key)
    diverged = Divergence(mujoco, model, data)
    limit = settles.max_speed
    seconds = settles.seconds
    if not model.opt.timestep > 0:
        return [failed("no time passes: the timestep of the model is 0", "a timestep above 0", "0")]
    steps = steps_in(model, seconds)
    dofs = np.flatnonzero([int(joint) in scope.joints for joint in model.dof_jntid])
    fastest = 0.0
    at = 0.0
    dof = -1
    first = steps - max(1, round(_AT_THE_END * steps))
    for step in range(steps):
        mujoco.mj_step(model, data)
        if diverged:  # MuJoCo resets it, so it is at rest
            message = f"the simulation diverges after {(step + 1) * model.opt.timestep:.4g} s"
            return [failed(message, f"at rest after {seconds:g} s", "not finite, or beyond all measure", "seconds")]
        if step >= first and len(dofs):
            speeds = np.abs(data.qvel[dofs])
            worst = int(speeds.argmax())
            if speeds[worst] > fastest:
                fastest = float(speeds[worst])
                at = float(data.time)
                dof = int(dofs[worst])
    scope.found("speed", fastest, SOLVED)
    if fastest <= limit:
        return [] if settles.near is None else _near(scope, data, settles.near, start=settles.key)
    joint = int(model.dof_jntid[dof])
    unit = _unit(model, dof, joint)
    speed = beside(fastest, limit)
    message = f"{scope.called('joint', joint)} still moves at {speed} {unit} after {at:.4g} s"
    return [failed(message, f"at most {limit:g} {unit}", f"{speed} {unit}", "max_speed")]


def _near(scope: Scope, data: MjData, near: Near, start: str | None) -> list[Fault]:
    """Report joints that end far from their position in a keyframe, by default the keyframe of the start."""
    import numpy as np

    key = near.key or start
    there = scope.at_key(key, "near", "key")
    mujoco = scope.mujoco
    model = scope.model
    apart = np.zeros(model.nv)
    mujoco.mj_differentiatePos(model, apart, 1.0, there.qpos, data.qpos)
    own = [dof for dof in range(model.nv) if int(model.dof_jntid[dof]) in scope.joints]
    if not own:
        return []
    dof = max(own, key=lambda each: abs(apart[each]))
    farthest = float(abs(apart[dof]))
    scope.found("distance", farthest, SOLVED)
    if farthest <= near.within:
        return []
    joint = int(model.dof_jntid[dof])
    unit = _unit(model, dof, joint).removesuffix("/s")
    where = f"`{key}`" if key else "the reference configuration"
    off = beside(farthest, near.within)
    message = f"{scope.called('joint', joint)} is {off} {unit} from where it is in {where}"
    return [failed(message, f"at most {near.within:g} {unit}", f"{off} {unit}", "near", "within")]


def _unit(model: MjModel, dof: int, joint: int) -> str:
    from mjcompose.mujoco.addresses import span

    return JOINT_TYPES[int(model.jnt_type[joint])].velocity_units[dof - span(model, "qvel", joint).start]
