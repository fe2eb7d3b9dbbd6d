"""Worlds for MuJoCo Warp, which steps them on a GPU, or slowly on a CPU."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from composer.compiled.varying import MEANS, value_of
from composer.worlds.errors import failure
from composer.worlds.probing import check_nothing_is_shared, is_stepped
from composer.worlds.simulator import Simulator
from composer.worlds.worlds import Worlds

_INSTEAD = "leave out of the recipe what changes it, or use `worlds.mujoco`"
_OF_SLEEP = "dof_length"
_FLUID = ("opt.density", "opt.viscosity", "opt.wind")
_IN_FLUID = ("body_fluid_box_adr", "body_fluid_ellipsoid_adr", "body_fluid_ellipsoid")
_FACTORS = ("efm0_", "dof_M0", _OF_SLEEP)
"""Arrays of Warp's model that its steps do not read, except with sleep or the discrete integrator."""


def warp(worlds: Worlds) -> Any:
    """Return a `mujoco_warp.Model` whose arrays have a row for each world, on Warp's default device.

        model = worlds.warp(study)
        data = mujoco_warp.make_data(study.nominal, nworld=study.count)
        mujoco_warp.step(model, data)

    Every array that differs is per world, including those that mj_setConst computes, which would be shared
    otherwise. Keys are not per world: `study.values("key_qpos")` has them. Arrays that Warp's model does not have
    play no part in its steps. Needs `mujoco_warp`; raises LoadError without it, for a model that Warp does not take,
    and for arrays that it shares between worlds.
    """
    try:
        import mujoco_warp
    except ImportError as error:
        raise failure(
            "not-installed", f"`mujoco_warp` cannot be used: {error}", "`pip install mujoco-warp`"
        ) from error
    simulator = Simulator("warp", mujoco_warp.put_model)
    model = simulator.take(worlds, worlds.nominal)
    names = per_world(model, worlds)
    check_nothing_is_shared(worlds, simulator, [*names, *unread(worlds)], instead=_INSTEAD)
    for name in names:
        put_worlds(model, name, worlds)
    return model


def per_world(model: Any, worlds: Worlds) -> list[str]:
    """Return the differing arrays that a `mujoco_warp.Model` can have for each world.

    Raises LoadError for another differing array that its steps read.
    """
    names = []
    for name in worlds.arrays:
        if _can_vary(model, name):
            names.append(name)
        elif _has(model, name) and is_stepped(name) and name not in unread(worlds):
            raise failure("not-per-world", f"MuJoCo Warp has `{name}` once for all worlds", _INSTEAD)
    return names


def put_worlds(model: Any, name: str, worlds: Worlds) -> None:
    """Replace an array of a `mujoco_warp.Model` by one with a row for each world."""
    import warp as wp

    owner, field = _owner(model, name)
    plain = getattr(owner, field)
    shape = (worlds.count, *plain.shape[1:], *getattr(plain.dtype, "_shape_", ()))
    numbers = worlds.values(name)
    kind = np.float32 if numbers.dtype.kind == "f" else numbers.dtype
    made = wp.array(numbers.reshape(shape).astype(kind), dtype=plain.dtype, device=plain.device)
    made._is_batched = True  # marks an array for each world, as opposed to one for all
    setattr(owner, field, made)


def _can_vary(model: Any, name: str) -> bool:
    if not _has(model, name):
        return False
    owner, field = _owner(model, name)
    spec = next((each.type for each in dataclasses.fields(owner) if each.name == field), None)
    shape = getattr(spec, "shape", None) or ("",)
    return bool(shape[0] == "*")


def unread(worlds: Worlds) -> list[str]:
    """Return the arrays that the steps of these worlds do not use."""
    import mujoco

    flag = getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", None)
    sleeps = flag is not None and bool(worlds.nominal.opt.enableflags & int(flag))
    discrete = getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", None)
    factored = discrete is not None and worlds.nominal.opt.integrator == int(discrete)
    read = (*((_OF_SLEEP,) if sleeps else ()), *(("efm0_",) if factored else ()))
    factors = [
        name for name in dir(worlds.nominal) if name.startswith(_FACTORS) and not name.startswith(read)
    ]
    fluid = [name for name in _FLUID if name in worlds.arrays or np.any(value_of(worlds.nominal, name))]
    return [*factors, *MEANS, *(() if fluid else _IN_FLUID)]


def _owner(model: Any, name: str) -> tuple[Any, str]:
    path, _, field = name.rpartition(".")
    return (getattr(model, path) if path else model), field


def _has(model: Any, name: str) -> bool:
    path, _, _ = name.rpartition(".")
    if path and not hasattr(model, path):
        return False
    owner, field = _owner(model, name)
    return hasattr(owner, field)
