"""In MuJoCo's process: all numbers of a model that differ between worlds, including those computed from draws."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from composer.compiled.kinds import Model
from composer.compiled.stored import stored
from composer.compiled.varying import Numbers, Recorder, arrays, flat, put
from composer.verify.run_time import are_close

Place = tuple[str, int]
"""A number of mjModel: its array and its index in the flattened array."""
_BLOCK = 1024


def compute(mujoco: Any, model: Model, asked: dict[str, Any]) -> list[str]:
    """Write every number that differs in some world to the file `out`, and return the names of the arrays.

    Runs under `composer.engine.call`. `draws` is a file with a row for each world, `(worlds, columns)`;
    `columns` says where the numbers go; `stored` says what is written. The model is restored afterwards.
    """
    draws, columns = np.load(asked["draws"], allow_pickle=False), asked["columns"]
    found, computed = Recorder(model), Computed(mujoco, model, mujoco.MjData(model))
    following = list(_following(model, columns))
    for first in range(0, len(draws), _BLOCK):
        drawn = list(_drawn(model, columns, following, rows=draws[first : first + _BLOCK], found=found))
        for world in range(len(draws[first : first + _BLOCK])):
            for memory, places, values in drawn:
                memory[places] = values[world]
            computed.settle()
            found.take()
    entries = stored(model, found.found())
    with open(asked["out"], "wb") as file:
        np.savez(file, allow_pickle=False, **entries)
    return sorted({name.partition("/")[0] for name in entries})


def _drawn(
    model: Model, columns: list[dict[str, Any]], following: list[tuple[Place, list[Place]]], rows: Numbers,
    found: Recorder,
) -> Iterator[tuple[Numbers, Numbers, Numbers]]:  # fmt: skip
    """Yield where in the model's memory drawn numbers go, and the numbers, `(worlds, numbers)`."""
    values: dict[Place, Numbers] = {}
    with np.errstate(all="ignore"):  # as with single numbers
        for column, drawn in zip(columns, rows.T, strict=True):
            is_drawn, ratio = ~np.isnan(drawn), np.ones(len(rows))
            for target in column["targets"]:
                array = getattr(model, target["array"])
                place = target["array"], int(np.ravel_multi_index(target["index"], array.shape))
                before = (
                    values[place]
                    if place in values
                    else np.repeat(flat(model, place[0])[place[1]], len(rows))
                )
                before = before.astype(float)
                signed = drawn * target.get("sign", 1)
                follows = target.get("follows")
                now = before * ratio if follows else {
                    "set": signed, "scale": before * drawn, "offset": before + signed,
                }[column["operation"]]  # fmt: skip
                values[place] = np.where(is_drawn, now, before).astype(array.dtype)
                if not follows:
                    ratio = np.where(before != 0, values[place].astype(float) / before, 1.0)
        for source, targets in following:
            for name, index in targets:
                values[name, index] = values[source].astype(getattr(model, name).dtype)
    for dtype in {value.dtype for value in values.values()}:
        places = [place for place, value in values.items() if value.dtype == dtype]
        memory = np.array([found.first_of(name) + index for name, index in places])
        yield found.view(dtype), memory, np.stack([values[place] for place in places], axis=1)


def compare(mujoco: Any, nominal: Model, sample: Model, asked: dict[str, Any]) -> list[str]:
    """Return the arrays in which `world` of the file `out` differs from a built sample.

    Runs under `composer.engine.call`. The nominal model is restored afterwards.
    """
    before = {name: flat(nominal, name).copy() for name in arrays(nominal)}
    with np.load(asked["out"], allow_pickle=False) as stored:
        for name in {each.partition("/")[0] for each in stored.files}:
            numbers = flat(nominal, name).copy()
            numbers[stored[f"{name}/index"]] = stored[f"{name}/values"][asked["world"]]
            put(nominal, name, numbers)
    different = [name for name in before if not are_close(flat(nominal, name), flat(sample, name))]
    for name, numbers in before.items():
        put(nominal, name, numbers)
    return sorted(different)


class Computed:
    """The values that the compiler computes and mj_setConst does not, unless the model sets them."""

    def __init__(self, mujoco: Any, model: Model, data: Any) -> None:
        self._mujoco, self._model, self._data = mujoco, model, data
        self._inertia, self._mass = model.stat.meaninertia, model.stat.meanmass
        self._has_inertia = are_close(_mean_inertia(model), self._inertia)
        self._has_mass = are_close(_mean_mass(model), self._mass)
        lengths = self._lengths() if model.ntendon else np.empty(0)
        # `springlength` is a range. If it is not set, both ends are the length in the springs' reference
        # pose.
        self._springs = [
            n for n, each in enumerate(lengths) if are_close(model.tendon_lengthspring[n], [each, each])
        ]

    def settle(self) -> None:
        """Compute them."""
        model = self._model
        # MuJoCo 3.12 computes lengths of tendons with mocap bodies where the data has them; 4.0 moves them first.
        self._mujoco.mj_resetData(model, self._data)
        self._mujoco.mj_setConst(model, self._data)
        # MuJoCo 3.12 computes these anew even if `<statistic>` gives them; 4.0 never does.
        model.stat.meaninertia = _mean_inertia(model) if self._has_inertia else self._inertia
        model.stat.meanmass = _mean_mass(model) if self._has_mass else self._mass
        if self._springs:
            model.tendon_lengthspring[self._springs] = self._lengths()[self._springs, None]

    def _lengths(self) -> Numbers:
        mujoco, model, data = self._mujoco, self._model, self._data
        mujoco.mj_resetData(model, data)
        data.qpos[:] = model.qpos_spring
        for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_tendon):
            stage(model, data)
        lengths: Numbers = data.ten_length.copy()
        return lengths


def _mean_inertia(model: Model) -> float:
    return sum(model.dof_M0.tolist()) / model.nv if model.nv else math.nan


def _mean_mass(model: Model) -> float:
    return sum(model.body_mass.tolist()) / (model.nbody - 1) if model.nbody > 1 else math.nan


_FREE = 0
_OF_INERTIA = {"body_pos": "body_ipos", "body_quat": "body_iquat"}
_OF_KEYS = {"body_pos": "key_mpos", "body_quat": "key_mquat"}


def _following(model: Model, columns: list[dict[str, Any]]) -> Iterator[tuple[Place, list[Place]]]:
    """Yield the numbers that the compiler copies from the pose of a body and mj_setConst does not update.

    The reference pose of a free joint is the pose of its body, and so is its pose in a key that does not set
    it.
    """
    for array, at, width in (("body_pos", 0, 3), ("body_quat", 3, 4)):
        drawn = {
            tuple(target["index"])
            for column in columns
            for target in column["targets"]
            if target["array"] == array
        }
        for body, component in sorted(drawn):
            targets = [
                *_of_free_joint(model, body, at + component),
                *_of_mocap(model, body, array, component=component),
                *_of_inertial_frame(model, body, array, component=component),
            ]
            if targets:
                yield (array, body * width + component), targets


def _of_free_joint(model: Model, body: int, component: int) -> Iterator[Place]:
    joint = model.body_jntadr[body]
    if joint < 0 or model.jnt_type[joint] != _FREE:
        return
    first = int(model.jnt_qposadr[joint])
    pose = slice(first, first + 7)
    yield "qpos0", first + component
    yield "qpos_spring", first + component
    for key in range(model.nkey):
        if (model.key_qpos[key, pose] == model.qpos0[pose]).all():
            yield "key_qpos", key * model.nq + first + component


def _of_inertial_frame(model: Model, body: int, array: str, component: int) -> Iterator[Place]:
    """Yield the number of the inertial frame: MuJoCo gives a massless body its own pose as the inertial frame."""
    name = _OF_INERTIA[array]
    if model.body_mass[body] == 0 and (getattr(model, name)[body] == getattr(model, array)[body]).all():
        yield name, body * getattr(model, name).shape[1] + component


def _of_mocap(model: Model, body: int, array: str, component: int) -> Iterator[Place]:
    mocap = int(model.body_mocapid[body])
    if mocap < 0:
        return
    name, pose = _OF_KEYS[array], getattr(model, array)[body]
    for key in range(model.nkey):
        first = pose.size * mocap
        if (getattr(model, name)[key, first : first + pose.size] == pose).all():
            yield name, key * pose.size * model.nmocap + first + component
