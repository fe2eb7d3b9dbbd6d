"""The check `reachable`: joint positions exist that bring a site to a point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.language.check import Check
from mjcompose.language.forms.scalars import LENGTHS, Expects, Items, Name, Scaled
from mjcompose.verify.checks.check import SOLVED, Scope, beside, failed

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData


class Reachable(Check):
    """The joints can bring a site to a point within their limits. Collisions do not count."""

    word: ClassVar = "reachable"
    needs_world: ClassVar = True
    example: ClassVar = "{site: tcp, target: [0.5, 0, 0.8]}"

    site: Annotated[str, Name("site")] = Field(examples=["NAME"])
    """the site to bring to the point"""
    target: Annotated[tuple[float, ...], Items(3, 3), Expects("a list of 3 numbers", "[0.5, 0, 0.8]")]
    """the point, in meters, in the world of this recipe"""
    tolerance: Annotated[float, Scaled(LENGTHS, gt=0)] = 1e-3
    """the largest remaining distance, in meters"""
    key: Annotated[str, Name("key", what="the name of a keyframe")] | None = None
    """the keyframe from which the search starts; by default the reference configuration"""


KIND = Reachable


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report that no joint positions were found, with the nearest point."""
    from mjcompose.verify.checks.inverse_kinematics import STARTS, Solver

    site = scope.find("site", asked["site"], "site")
    data = scope.at_key(asked["key"])
    scope.mujoco.mj_kinematics(scope.model, data)
    target = _in_the_world(scope, data, asked["target"], frame=asked["frame"])
    solver = Solver(scope.mujoco, scope.model, data, site=site, target=target, tolerance=asked["tolerance"])
    distance = solver.solve() if len(solver.chain) else solver.distance
    scope.found("distance", distance, SOLVED)
    if distance <= asked["tolerance"]:
        return []
    more = [
        f"{STARTS} starts were tried" if len(solver.chain) else "no joint moves it; free joints stay where they are"
    ]
    if solver.at_limits:
        names = ", ".join(scope.written("joint", joint) for joint in solver.at_limits)
        more.append(f"at the nearest pose, joints are at their limits: {names}")
    point = ", ".join(f"{each:g}" for each in asked["target"])
    nearest = beside(distance, asked["tolerance"])
    message = f"site `{asked['site']}` comes no nearer to [{point}] than {nearest} m"
    return [failed(message, f"within {asked['tolerance']:g} m", f"{nearest} m", "target", more=more)]


def _in_the_world(scope: Scope, data: MjData, target: list[float], frame: dict[str, Any]) -> Any:
    """Convert a point from the recipe's world, whose pose in the model is `frame`, to the model's."""
    import numpy as np

    turned = np.zeros(3)
    scope.mujoco.mju_rotVecQuat(turned, np.array(target, dtype=np.float64), np.array(frame["quat"], dtype=np.float64))
    point = turned + np.array(frame["pos"], dtype=np.float64)
    if frame["body"] is None:
        return point
    body = scope.roster.ids["body"][frame["body"]]
    return data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
