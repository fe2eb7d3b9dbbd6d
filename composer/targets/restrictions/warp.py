"""Limits of MuJoCo Warp: what `put_model` of MuJoCo Warp 4.0 refuses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from composer.targets.limit import Outcome
from composer.targets.restrictions.compiled import (
    is_enabled,
    refused_elements,
    refused_members,
    refused_options,
    with_plugins,
)

_OUT = "leave it out with `edit`"
_DENSE_DOFS = 60
_AXES = np.eye(3)

WARP_ACTUATORS = refused_members(
    "actuators", "actuator",
    (
        ("actuator_trntype", "mjtTrn", ("mjTRN_SO3",), "MuJoCo Warp has no such transmission"),
        ("actuator_dyntype", "mjtDyn", ("mjDYN_PID",), "MuJoCo Warp has no such dynamics"),
        ("actuator_gaintype", "mjtGain", ("mjGAIN_PID",), "MuJoCo Warp has no such gain"),
        ("actuator_biastype", "mjtBias", ("mjBIAS_SO3",), "MuJoCo Warp has no such bias"),
    ),
    help="write a `motor` or a `position` in its place: `convert: {to: position}`",
)  # fmt: skip
WARP_EQUALITY = refused_members(
    "equality", "equality",
    (("eq_type", "mjtEq", ("mjEQ_FLEXVERT", "mjEQ_DISTANCE"), "MuJoCo Warp has no such constraint"),),
    help=_OUT,
)  # fmt: skip


def _options(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """Options that MuJoCo Warp has, but not beside others."""
    option, sleeps = model.opt, is_enabled(mujoco, model, "sleep")
    discrete = getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", None)
    if option.noslip_iterations > 0 and discrete is not None and option.integrator == int(discrete):
        yield 0, "MuJoCo Warp has no `noslip_iterations` with the integrator `discrete`"
    if option.jacobian == int(mujoco.mjtJacobian.mjJAC_DENSE) and model.nv > _DENSE_DOFS:
        yield 0, f"MuJoCo Warp has no `jacobian` `dense` for more than {_DENSE_DOFS} degrees of freedom"
    if sleeps and option.solver != int(mujoco.mjtSolver.mjSOL_NEWTON):
        yield 0, "MuJoCo Warp has the flag `sleep` with the solver `Newton` alone"
    if sleeps and (model.eq_type == int(mujoco.mjtEq.mjEQ_FLEX)).any():
        yield 0, "MuJoCo Warp has no flag `sleep` with equality constraints of flexes"


def _simple(mujoco: Any, model: Any, flex: int) -> bool:
    """Whether each vertex of a flex is in the world or on a body of its own, with the three slides of a flexcomp."""
    first = int(model.flex_vertadr[flex])
    for holder in set(model.flex_vertbodyid[first : first + int(model.flex_vertnum[flex])].tolist()):
        body = int(model.body_weldid[holder]) if holder >= 0 else 0
        if model.body_dofnum[body] == 0:
            continue
        joints = slice(int(model.body_jntadr[body]), int(model.body_jntadr[body] + model.body_jntnum[body]))
        slides = (model.jnt_type[joints] == int(mujoco.mjtJoint.mjJNT_SLIDE)).all()
        above = int(model.body_weldid[model.body_parentid[body]])
        if not (slides and model.body_dofnum[body] == len(_AXES) and model.body_dofnum[above] == 0):
            return False
        if not np.allclose(model.jnt_axis[joints], _AXES, atol=1e-15):
            return False
    return True


def _is_elastic(model: Any, flex: int) -> bool:
    bends = model.flex_bendingadr[flex] >= 0
    at = int(model.flex_stiffnessadr[flex])
    return bool(bends or (model.flex_dim[flex] > 1 and at >= 0 and model.flex_stiffness[at] != 0))


WARP_OPTIONS = refused_options(
    "options",
    "MuJoCo Warp",
    (("solver", "mjtSolver", ("mjSOL_PGS",)),),
    flags=("override", "fwdinv", "diagexact", "ipc", "speculative"),
    help="write another one in the section `option` of the recipe",
    together=_options,
)


WARP_PLUGINS = refused_elements("plugins", "body", with_plugins("body"), help=_OUT)
WARP_ACTUATOR_PLUGINS = refused_elements("actuators", "actuator", with_plugins("actuator"), help=_OUT)
WARP_SENSORS = refused_elements("sensors", "sensor", with_plugins("sensor"), help=_OUT)


def _sleepers(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """Yield the bodies that set `sleep` themselves; otherwise the compiler chooses `auto_…`."""
    policies = getattr(mujoco, "mjtSleepPolicy", None)
    if policies is not None:
        for body, policy in zip(model.tree_bodyadr.tolist(), model.tree_sleep_policy.tolist(), strict=True):
            if policy in map(int, (policies.mjSLEEP_NEVER, policies.mjSLEEP_ALLOWED, policies.mjSLEEP_INIT)):
                yield body, "MuJoCo Warp does not have `sleep` of a body"


WARP_SLEEP = refused_elements(
    "sleep", "body", _sleepers, help="write `unset: [sleep]`", outcome=Outcome.REFUSED
)


def _flexes(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """Yield the flexes that it refuses: quadratic and rigid ones, and those with some kinds of contacts."""
    nothing = np.zeros(model.nflex, dtype=int)  # a MuJoCo may not have all of these
    interpolated, rigid, internal, passive = (
        getattr(model, name, nothing)
        for name in ("flex_interp", "flex_rigid", "flex_internal", "flex_passive")
    )
    discrete = getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", None)
    newton = (
        discrete is not None
        and model.opt.integrator == int(discrete)
        and model.opt.solver == int(mujoco.mjtSolver.mjSOL_NEWTON)
        and hasattr(model, "flex_stiffnessadr")
    )
    touching = (model.flex_contype & model.flex_conaffinity) != 0
    for number in range(model.nflex):
        if abs(int(interpolated[number])) == 2:
            yield number, "MuJoCo Warp has no flexes of quadratic elements"
        elif rigid[number]:
            yield number, "MuJoCo Warp has no rigid flexes"
        elif internal[number]:
            yield number, "MuJoCo Warp has no contacts inside a flex: `internal`"
        elif interpolated[number] and model.flex_selfcollide[number] and touching[number]:
            yield number, "MuJoCo Warp has no contacts of an interpolated flex with itself: `selfcollide`"
        elif interpolated[number] and passive[number] and model.flex_dim[number] >= 2:
            yield number, "MuJoCo Warp has no passive contacts of an interpolated flex: `passive`"
        elif (
            newton
            and not interpolated[number]
            and _is_elastic(model, number)
            and not _simple(mujoco, model, number)
        ):
            yield (
                number,
                "MuJoCo Warp has no elastic flex on moving bodies with `discrete` and the solver `Newton`",
            )


def _beside_flexes(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """The shapes that MuJoCo Warp refuses in a model with flexes, whether they touch one or not."""
    if model.nflex:
        for word in ("sdf", "hfield"):
            shape = int(getattr(mujoco.mjtGeom, f"mjGEOM_{word.upper()}"))
            for number in np.flatnonzero(model.geom_type == shape).tolist():
                yield number, f"MuJoCo Warp has no `{word}` in a model with flexes"


def _velocities(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    """The contact sensors with `linvel` or `angvel` in a model with flexes."""
    fields = getattr(mujoco, "mjtConDataField", None)
    if fields is None or not model.nflex:
        return
    bits = 1 << int(fields.mjCONDATA_LINVEL) | 1 << int(fields.mjCONDATA_ANGVEL)
    contact = int(mujoco.mjtSensor.mjSENS_CONTACT)
    for number in np.flatnonzero(model.sensor_type == contact).tolist():
        if int(model.sensor_intprm[number][0]) & bits:
            yield number, "MuJoCo Warp has no `linvel` and `angvel` of contacts in a model with flexes"


WARP_FLEXES = refused_elements("soft", "flex", _flexes, help=_OUT)
WARP_BESIDE_FLEXES = refused_elements("soft", "geom", _beside_flexes, help=_OUT)
WARP_VELOCITIES = refused_elements(
    "contact sensors", "sensor", _velocities, help="leave `linvel` and `angvel` out of its `data`"
)
