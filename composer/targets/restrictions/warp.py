"""Limits of MuJoCo Warp: what `put_model` of MuJoCo Warp 4.0 refuses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from composer.targets.restrictions.compiled import (
    refused_elements,
    refused_members,
    refused_options,
    with_plugins,
)
from composer.targets.restrictions.left_out import refused

_OUT = "leave it out with `edit`"
_AWAKE = "write `set: {sleep: allowed}`"

WARP_ACTUATORS = refused_members(
    "actuators", "actuator",
    (
        ("actuator_trntype", "mjtTrn", ("mjTRN_SO3",), "MuJoCo Warp has no such transmission"),
        ("actuator_dyntype", "mjtDyn", ("mjDYN_PID",), "MuJoCo Warp has no such dynamics"),
        ("actuator_gaintype", "mjtGain", ("mjGAIN_PID",), "MuJoCo Warp has no such gain"),
        ("actuator_biastype", "mjtBias", ("mjBIAS_SO3",), "MuJoCo Warp has no such bias"),
    ),
    "write a `motor` or a `position` in its place: `convert: {to: position}`",
)  # fmt: skip
WARP_EQUALITY = refused_members(
    "equality", "equality",
    (("eq_type", "mjtEq", ("mjEQ_FLEXVERT", "mjEQ_DISTANCE"), "MuJoCo Warp has no such constraint"),),
    _OUT,
)  # fmt: skip
WARP_OPTIONS = refused_options(
    "options",
    "MuJoCo Warp",
    (("solver", "mjtSolver", ("mjSOL_PGS",)),),
    ("override", "fwdinv", "diagexact", "ipc", "speculative"),
    "write another one in the section `option` of the recipe",
)


WARP_PLUGINS = refused_elements("plugins", "body", with_plugins("body"), _OUT)
WARP_ACTUATOR_PLUGINS = refused_elements("actuators", "actuator", with_plugins("actuator"), _OUT)
WARP_SLEEP = refused(
    "sleep", ".//body[@sleep='init']", "MuJoCo Warp has no body that sleeps from the start", _AWAKE
)
WARP_SENSORS = refused_elements("sensors", "sensor", with_plugins("sensor"), _OUT)


def _flexes(_mujoco: object, model: Any) -> Iterator[tuple[int, str]]:
    """Yield the flexes that it refuses: quadratic and rigid ones, and those with contacts between their own parts."""
    nothing = np.zeros(model.nflex, dtype=int)  # a MuJoCo may not have all of these
    interpolated, rigid, internal = (
        getattr(model, name, nothing) for name in ("flex_interp", "flex_rigid", "flex_internal")
    )
    for number in range(model.nflex):
        if abs(int(interpolated[number])) == 2:
            yield number, "MuJoCo Warp has no flexes of quadratic elements"
        elif rigid[number]:
            yield number, "MuJoCo Warp has no rigid flexes"
        elif internal[number]:
            yield number, "MuJoCo Warp has no contacts inside a flex: `internal`"


WARP_FLEXES = refused_elements("soft", "flex", _flexes, _OUT)
