"""The check `size`."""

from __future__ import annotations

from typing import Any

from composer.compiled.kinds import JOINT_POSITIONS, JOINT_VELOCITIES
from composer.verify.kinds.finding import Finding, failed
from composer.verify.kinds.scope import Scope

_COUNTED = {
    "njnt": "joint",
    "ngeom": "geom",
    "nsite": "site",
    "ncam": "camera",
    "nlight": "light",
    "nflex": "flex",
    "nskin": "skin",
    "nmesh": "mesh",
    "nhfield": "hfield",
    "ntex": "texture",
    "nmat": "material",
    "npair": "pair",
    "nexclude": "exclude",
    "neq": "equality",
    "ntendon": "tendon",
    "nactuator": "actuator",
    "nsensor": "sensor",
    "nnumeric": "numeric",
    "ntext": "text",
    "ntuple": "tuple",
    "nplugin": "plugin",
}
_SUMMED = {
    "nu": ("actuator", "actuator_ctrlnum"),
    "na": ("actuator", "actuator_actnum"),
    "nsensordata": ("sensor", "sensor_dim"),
}


def check(scope: Scope, asked: dict[str, Any]) -> list[Finding]:
    """One finding for each size that is another. Keyframes that merged belong to no recipe alone."""
    found: list[Finding] = []
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
    """A size of mjModel, as far as it is the recipe's own; None where that cannot be told apart."""
    model = scope.model
    if scope.whole:
        value = getattr(model, size, None)
        return scope.roster.count("actuator") if value is None and size == "nactuator" else value
    if size in _COUNTED:
        return len(list(scope.own(_COUNTED[size])))
    if size == "nbody":
        return 1 + len(list(scope.own("body")))  # the world is in every model
    if size == "nmocap":
        return sum(int(model.body_mocapid[index]) >= 0 for index in scope.own("body"))
    if size in ("nq", "nv"):
        widths = JOINT_POSITIONS if size == "nq" else JOINT_VELOCITIES
        return sum(widths[int(model.jnt_type[index])] for index in scope.joints)
    if size in _SUMMED:
        kind, array = _SUMMED[size]
        each = getattr(model, array, None)
        return sum(1 if each is None else int(each[index]) for index in scope.own(kind))
    return None
