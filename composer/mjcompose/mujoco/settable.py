"""Numbers of a compiled model that a program can change: where they are, and the values that follow from them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.addresses import rows_of
from mjcompose.mujoco.attributes import ON_BODIES, TAGS, array_of, attributes
from mjcompose.mujoco.controls import GAINS
from mjcompose.mujoco.unequal import Bound, unequal
from mjcompose.mujoco.varying import Numbers

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_MASS = "mass"
_CLOSE = 1e-9
"""Tolerance for numbers that were computed in two ways, relative to the larger of 1 and the number."""


def resolve_addresses(mujoco: Any, model: MjModel, asked: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return for each element its id and the addresses of its numbers in mjModel, or an `error`.

    Runs under `mjcompose.mujoco.engine.call`. Each question has `tag`, `family`, `name` or `place`, `attribute`, and
    `start` and `count` of its numbers. The answer has `id`, and under `targets` for each number a list of
    `{array, index}`; with a `sign` if it is not 1, and with `follows` if the value changes in proportion to the first.
    """
    return [_resolved(mujoco, model, each) for each in asked]


def _resolved(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> dict[str, Any]:
    tag = asked["tag"]
    family = asked["family"]
    attribute = asked["attribute"]
    gains = GAINS.get((tag, attribute))
    if family not in TAGS or not (gains or attribute in attributes(family)):
        return {"error": f"`{attribute}` of `{tag}` is not an array of mjModel"}
    number = _id(mujoco, model, asked)
    if isinstance(number, str):
        return {"error": number, "nameless": not asked["name"]}
    if family == "body" and attribute == _MASS:
        inertia = [{"array": "body_inertia", "index": [number, n], "follows": True} for n in range(3)]
        return {"id": number, "targets": [[{"array": "body_mass", "index": [number]}, *inertia]]}
    if gains is not None:
        targets = [{"array": array, "index": [number, n], "sign": sign} for array, n, sign in gains]
        return {"id": number, "targets": [targets]}
    return _targets(model, asked, number)


def _targets(model: MjModel, asked: dict[str, Any], number: int) -> dict[str, Any]:
    """Return the numbers of mjModel that a draw of an attribute sets, of the element with a number."""
    family = asked["family"]
    array = array_of(family, asked["attribute"])
    rows = rows_of(model, family, array, index=number)
    if family == "actuator":
        # In MuJoCo 4.0, some have several controls (`pid`, `orientation`): the draw is for the first.
        rows = range(rows.start, rows.start + 1)
    values = getattr(model, array, None)
    is_flat = values is not None and values.ndim == 1
    width = 1 if values is None or is_flat else int(np.prod(values.shape[1:]))
    last = asked["start"] + asked["count"]
    if values is None or last > width:
        return {"error": f"`{asked['attribute']}` of `{asked['tag']}` does not have that many numbers in mjModel"}
    targets = [
        [{"array": array, "index": [row] if is_flat else [row, column]} for row in rows]
        for column in range(asked["start"], last)
    ]
    return {"id": number, "targets": targets}


def _id(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> int | str:
    family = asked["family"]
    name = asked["name"]
    place = asked["place"]
    if name:
        number = int(mujoco.mj_name2id(model, getattr(mujoco.mjtObj, f"mjOBJ_{family.upper()}"), name))
        return number if number >= 0 else f"the compiled model has no {family} `{name}`"
    if place is None:
        return f"a `{asked['tag']}` without a name cannot be found in the compiled model"
    body, position, count = place
    number = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body))
    if number < 0 or family not in ON_BODIES:
        return f"a `{asked['tag']}` without a name cannot be found in the compiled model"
    there = np.flatnonzero(getattr(model, ON_BODIES[family]) == number)
    if len(there) != count:
        return f"the {family}s without a name in body `{body}` cannot be distinguished"
    return int(there[position])


def are_close(a: Any, b: Any) -> bool:
    """Return whether numbers are equal up to the rounding errors of two ways to compute them."""
    a = np.asarray(a)
    b = np.asarray(b)
    bound = Bound(_CLOSE if a.dtype.itemsize == 8 else 1e-5)
    return a.shape == b.shape and not unequal(b, a, bound).any()


class DerivedValues:
    """The values that the compiler computes but mj_setConst does not, unless the model sets them."""

    def __init__(self, mujoco: Any, model: MjModel, data: MjData) -> None:
        self._mujoco = mujoco
        self._model = model
        self._data = data
        self._inertia = model.stat.meaninertia
        self._mass = model.stat.meanmass
        self._has_inertia = are_close(_mean_inertia(model), self._inertia)
        self._has_mass = are_close(_mean_mass(model), self._mass)
        lengths = self._lengths() if model.ntendon else np.empty(0)
        # If the range `springlength` is not set, both ends are the length in the springs' reference pose.
        self._springs = [n for n, each in enumerate(lengths) if are_close(model.tendon_lengthspring[n], [each, each])]

    def settle(self) -> None:
        model = self._model
        # MuJoCo 3.12 computes lengths of tendons with mocap bodies where the data has them; 4.0 moves them first.
        self._mujoco.mj_resetData(model, self._data)
        self._mujoco.mj_setConst(model, self._data)
        # MuJoCo 3.12 computes these again even if `<statistic>` gives them; 4.0 never does.
        model.stat.meaninertia = _mean_inertia(model) if self._has_inertia else self._inertia
        model.stat.meanmass = _mean_mass(model) if self._has_mass else self._mass
        if self._springs:
            model.tendon_lengthspring[self._springs] = self._lengths()[self._springs, None]

    def _lengths(self) -> Numbers:
        mujoco = self._mujoco
        model = self._model
        data = self._data
        mujoco.mj_resetData(model, data)
        data.qpos[:] = model.qpos_spring
        for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_tendon):
            stage(model, data)
        lengths: Numbers = data.ten_length.copy()
        return lengths


def _mean_inertia(model: MjModel) -> float:
    return sum(model.dof_M0.tolist()) / model.nv if model.nv else math.nan


def _mean_mass(model: MjModel) -> float:
    return sum(model.body_mass.tolist()) / (model.nbody - 1) if model.nbody > 1 else math.nan
