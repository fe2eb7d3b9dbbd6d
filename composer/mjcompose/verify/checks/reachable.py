"""The check `reachable`: joint positions exist that bring a site to a point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import Fault
from mjcompose.language.checks.reachable import Reachable
from mjcompose.verify.checks.check import SOLVED, Scope, beside, failed

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData


def check(scope: Scope, reachable: Reachable) -> list[Fault]:
    """Report that no joint positions were found, with the nearest point."""
    from mjcompose.verify.checks.inverse_kinematics import STARTS, Solver

    site = scope.find("site", reachable.site, "site")
    data = scope.at_key(reachable.key)
    scope.mujoco.mj_kinematics(scope.model, data)
    target = _in_the_world(scope, data, reachable.target)
    solver = Solver(scope.mujoco, scope.model, data, site=site, target=target, tolerance=reachable.tolerance)
    distance = solver.solve() if len(solver.chain) else solver.distance
    scope.found("distance", distance, SOLVED)
    if distance <= reachable.tolerance:
        return []
    more = [
        f"{STARTS} starts were tried" if len(solver.chain) else "no joint moves it; free joints stay where they are"
    ]
    if solver.at_limits:
        names = ", ".join(scope.written("joint", joint) for joint in solver.at_limits)
        more.append(f"at the nearest pose, joints are at their limits: {names}")
    point = ", ".join(f"{each:g}" for each in reachable.target)
    nearest = beside(distance, reachable.tolerance)
    message = f"site `{reachable.site}` comes no nearer to [{point}] than {nearest} m"
    return [failed(message, f"within {reachable.tolerance:g} m", f"{nearest} m", "target", more=more)]


def _in_the_world(scope: Scope, data: MjData, target: Sequence[float]) -> Any:
    """Convert a point from the recipe's world to the model's."""
    import numpy as np

    world = scope.facts.world
    assert world is not None  # else the check does not run

    turned = np.zeros(3)
    scope.mujoco.mju_rotVecQuat(turned, np.array(target, dtype=np.float64), np.array(world.quat, dtype=np.float64))
    point = turned + np.array(world.pos, dtype=np.float64)
    if world.body is None:
        return point
    body = scope.roster.ids["body"][world.body]
    return data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
