"""Stiffness and damping that MuJoCo computes from the inertia of the whole model.

A part with a damping ratio gets another damping if something heavy is attached to it; it is unchanged as long as
the ratio is. The compiled model does not store the ratio, but it follows from the gain and the inertia in the same
model.
"""

from __future__ import annotations

import math

from composer.compiled.addresses import rows_of, span
from composer.compiled.joints import SLIDE
from composer.compiled.kinds import Model
from composer.compiled.links import ON_JOINTS, ON_TENDON, WRAP_JOINT
from composer.compiled.servos import servo

_CLOSE = 1e-6


def same_stiffness(alone: Model, composed: Model, joint: int, target: int) -> bool:
    """Return whether stiffness times inverse inertia, in 1/s², is the same; `springdamper` sets the stiffness by it."""
    mine = float(alone.jnt_stiffness[joint]) * _inverse_inertia(alone, joint)
    theirs = float(composed.jnt_stiffness[target]) * _inverse_inertia(composed, target)
    return math.isclose(mine, theirs, rel_tol=_CLOSE)


def same_damping(alone: Model, composed: Model, joint: int, target: int) -> bool:
    """Return whether damping times inverse inertia, in 1/s, is the same; `springdamper` sets the damping by it."""
    mine = float(alone.dof_damping[alone.jnt_dofadr[joint]]) * _inverse_inertia(alone, joint)
    theirs = float(composed.dof_damping[composed.jnt_dofadr[target]]) * _inverse_inertia(composed, target)
    return math.isclose(mine, theirs, rel_tol=_CLOSE)


def _inverse_inertia(model: Model, joint: int) -> float:
    return float(model.dof_invweight0[span(model, "qvel", joint)].mean())


def same_dampratio(alone: Model, composed: Model, actuator: int, target: int) -> bool:
    """Return whether a position servo has the same damping ratio in both models.

    Return False if the ratio is unknown. MuJoCo 4 takes the inertia from the inverse weight at the joint or tendon,
    MuJoCo 3 from the diagonal of the mass matrix; one match is enough.
    """
    if not (_is_damped_servo(alone, actuator) and _is_damped_servo(composed, target)):
        return False
    mine, theirs = alone.actuator_biasprm[actuator].tolist(), composed.actuator_biasprm[target].tolist()
    if mine[:2] != theirs[:2] or mine[3:] != theirs[3:]:
        return False
    return any(
        math.isclose(a, b, rel_tol=_CLOSE)
        for a, b in zip(_ratios(alone, actuator), _ratios(composed, target), strict=False)
        if a is not None and b is not None
    )


def _is_damped_servo(model: Model, actuator: int) -> bool:
    gains = servo(model, actuator) or {}
    return gains.get("kp", 0) > 0 and gains.get("kv", 0) > 0


def _ratios(model: Model, actuator: int) -> tuple[float | None, float | None]:
    """Return the damping ratio of a servo by the inverse weight and by the mass matrix, each None if unknown."""
    gains = servo(model, actuator) or {}
    stiffness, damping = gains["kp"], gains["kv"]
    output = rows_of(model, "actuator", "actuator_gear", index=actuator).start
    gear = float(model.actuator_gear[output, 0])
    kind, target = int(model.actuator_trntype[actuator]), int(model.actuator_trnid[actuator, 0])
    if gear == 0:
        return None, None
    if kind in ON_JOINTS:
        if int(model.jnt_type[target]) < SLIDE:
            return None, None
        dof = int(model.jnt_dofadr[target])
        light, heavy = float(model.dof_invweight0[dof]), float(model.dof_M0[dof])
    elif kind == ON_TENDON:
        light, heavy = float(model.tendon_invweight0[target]), _inertia_along(model, target)
    else:
        return None, None
    by_weight = damping * gear / (2 * math.sqrt(stiffness / light)) if light > 0 else None
    by_mass = damping * gear / (2 * math.sqrt(stiffness * heavy)) if heavy > 0 else None
    return by_weight, by_mass


def _inertia_along(model: Model, tendon: int) -> float:
    """Return the inertia that a fixed tendon moves; 0 for a spatial one, whose moments the model does not store."""
    first = int(model.tendon_adr[tendon])
    inertia = 0.0
    for at in range(first, first + int(model.tendon_num[tendon])):
        joint, coefficient = int(model.wrap_objid[at]), float(model.wrap_prm[at])
        if int(model.wrap_type[at]) != WRAP_JOINT or coefficient == 0:
            return 0.0
        inertia += float(model.dof_M0[model.jnt_dofadr[joint]]) / coefficient**2
    return inertia
