"""The check `clear`: a distance between geoms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import SOLVED, Scope, at_keys, beside, failed, keys_named, unmet

_SHOWN = 8


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report the closest pairs of geoms that are nearer to each other than the check allows."""
    sides = []
    for index, globs in enumerate(asked["between"]):
        if (nothing := unmet(scope, ("geom", "body"), globs, "between", index)) is not None:
            return [nothing]
        sides.append(_geoms(scope, globs))
    keys = keys_named(scope, asked["keys"]) if asked["keys"] else []
    if isinstance(keys, Fault):
        return [keys]
    poses = [*at_keys(scope, keys)] if keys else [("", scope.at_key(None))]
    close: list[tuple[float, str]] = []
    least = np.inf
    for name, data in poses:
        scope.mujoco.mj_kinematics(scope.model, data)
        for one, other, distance in _pairs(scope, data, sides, limit=asked["distance"]):
            least = min(least, distance)
            if distance < asked["distance"]:
                where = f" in `{name}`" if name else ""
                pair = f"{scope.called('geom', one)} and {scope.called('geom', other)}"
                close.append((distance, f"{pair}{where}: {beside(distance, asked['distance'])} m"))
    if np.isfinite(least):
        scope.found("distance", float(least), SOLVED)
    if not close:
        return []
    ranked = [text for _, text in sorted(close)]
    more = ranked[1:_SHOWN] + ([f"and {len(ranked) - _SHOWN} more pairs"] if len(ranked) > _SHOWN else [])
    pair, _, actual = ranked[0].rpartition(": ")
    message = f"{pair} are {actual} apart"
    return [failed(message, f"at least {asked['distance']:g} m", actual, "distance", more=more)]


def _geoms(scope: Scope, globs: Sequence[str]) -> list[int]:
    """Return the geoms that the globs match, and the geoms of the bodies that they match."""
    found: list[int] = []
    for glob in globs:
        found += scope.matching("geom", glob)
        bodies = set(scope.matching("body", glob))
        found += [geom for geom in scope.own("geom") if int(scope.model.geom_bodyid[geom]) in bodies]
    return list(dict.fromkeys(found))


def _pairs(scope: Scope, data: Any, sides: list[list[int]], limit: float) -> list[tuple[int, int, float]]:
    """Yield pairs of geoms on different bodies with their distance, at most the limit."""
    mujoco, model = scope.mujoco, scope.model
    found = []
    for one in sides[0]:
        for other in sides[1]:
            if one == other or model.geom_bodyid[one] == model.geom_bodyid[other]:
                continue
            apart = float(np.linalg.norm(data.geom_xpos[one] - data.geom_xpos[other]))
            radius = float(model.geom_rbound[one] + model.geom_rbound[other])
            if model.geom_rbound[one] and model.geom_rbound[other] and apart - radius >= limit:
                continue  # their bounding spheres are apart: no need to ask MuJoCo
            distance = float(mujoco.mj_geomDistance(model, data, one, other, limit + 1e-9, None))
            found.append((one, other, distance))
    return found
