"""The check `budget`."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, at_keys, failed, keys_named

_WARM_UP, _SECONDS, _RUNS = 20, 0.2, 3
_SHOWN_SPEED = 2
"""Digits: the speed differs from run to run."""


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Return one finding for each thing of which there is more than allowed."""
    keys = keys_named(scope, asked["keys"])
    if isinstance(keys, Fault):
        return [keys]
    counted: Mapping[str, Callable[[], tuple[int, str]]] = {
        "faces": lambda: (_faces(scope), ", in all meshes together"),
        "bytes": lambda: (int(asked["bytes"]), ", in all files of the model together"),
        "textures": lambda: (_textures(scope), " bytes in memory"),
        "contacts": lambda: _contacts(scope, keys, everywhere=not asked["keys"]),
    }
    found: list[Fault] = []
    for name, most in asked["most"].items():
        value, words = counted[name]()
        scope.found(name, value)
        if value > most:
            found.append(failed(f"`{name}` is {value}{words}", f"at most {most:.15g}", str(value), name))
    if asked["speed"] is not None:
        found += _speed(scope, asked["speed"])
    return found


def _faces(scope: Scope) -> int:
    return int(sum(int(scope.model.mesh_facenum[mesh]) for mesh in scope.own("mesh")))


def _textures(scope: Scope) -> int:
    model, total = scope.model, 0
    for texture in scope.own("texture"):
        total += (
            int(model.tex_height[texture]) * int(model.tex_width[texture]) * int(model.tex_nchannel[texture])
        )
    return total


def _contacts(scope: Scope, keys: list[str], *, everywhere: bool) -> tuple[int, str]:
    """Return the largest number of the recipe's own contacts, and where it occurs."""
    poses = [("the reference configuration", scope.mujoco.MjData(scope.model))] if everywhere else []
    poses += [(f"`{name}`", data) for name, data in at_keys(scope, keys)]
    most, where = 0, "the reference configuration"
    for name, data in poses:
        scope.mujoco.mj_fwdPosition(scope.model, data)
        count = sum(
            all(geom < 0 or scope.owns("geom", int(geom)) for geom in contact.geom)
            for contact in data.contact
        )
        if count > most:
            most, where = count, name
    return most, f", in {where}"


def _speed(scope: Scope, least: float) -> list[Fault]:
    """Return a finding if the best of several runs is too slow. The best one is disturbed least by other work."""
    mujoco, model = scope.mujoco, scope.model
    data = mujoco.MjData(model)
    best = 0.0
    for _ in range(_RUNS):
        mujoco.mj_resetData(model, data)
        mujoco.mj_step(model, data, nstep=_WARM_UP)
        steps, begin = 0, time.thread_time()
        while (spent := time.thread_time() - begin) < _SECONDS:
            mujoco.mj_step(model, data, nstep=10)
            steps += 10
        best = max(best, steps / spent)
    speed = float(np.format_float_positional(best, precision=_SHOWN_SPEED, fractional=False, trim="-"))
    if best >= least:
        return []
    message = f"one thread of this machine takes {speed:g} steps in a second"
    more = ("that is a measurement of this machine; it counts the time of the processor",)
    return [failed(message, f"at least {least:g}", f"{speed:g}", "steps_per_second", more=more)]
