"""The check `budget`: limits of a model's cost."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping

from mjcompose.base.diagnostic import Fault
from mjcompose.language.checks.budget import Budget
from mjcompose.verify.checks.check import Scope, at_keys, failed, keys_named

_WARM_UP = 20
_SECONDS = 0.2
_RUNS = 3
_OF_A_MESH = {"vert": 12, "normal": 12, "texcoord": 8, "face": 36}
"""Bytes of each: two or three single-precision numbers, or nine indices for a face."""
_SHOWN_SPEED = 2
"""Digits: the speed differs from run to run."""


def check(scope: Scope, budget: Budget) -> list[Fault]:
    """Return one finding for each exceeded limit."""
    keys = keys_named(scope, budget.key)
    faces = scope.model.mesh_facenum
    counted: Mapping[str, Callable[[], tuple[int, str]]] = {
        "geoms": lambda: (len(list(scope.own("geom"))), ""),
        "meshes": lambda: (_meshes(scope), " bytes in memory"),
        "faces": lambda: (sum(int(faces[mesh]) for mesh in scope.own("mesh")), ", in all meshes together"),
        "bytes": lambda: (scope.facts.size, ", in all files of the model together"),
        "textures": lambda: (_textures(scope), " bytes in memory"),
        "contacts": lambda: _contacts(scope, keys, everywhere=not budget.key),
    }
    found: list[Fault] = []
    for name, count in counted.items():
        most = getattr(budget, name)
        if most is None:
            continue
        value, words = count()
        scope.found(name, value)
        if value > most:
            found.append(failed(f"`{name}` is {value}{words}", f"at most {most:.15g}", str(value), name))
    if budget.steps_per_second is not None:
        found += _speed(scope, budget.steps_per_second)
    return found


def _meshes(scope: Scope) -> int:
    """Return the bytes of the points, normals, texture coordinates and faces of all meshes."""
    counts = [(getattr(scope.model, f"mesh_{each}num"), width) for each, width in _OF_A_MESH.items()]
    return sum(int(count[mesh]) * width for mesh in scope.own("mesh") for count, width in counts)


def _textures(scope: Scope) -> int:
    sizes = scope.model.tex_height, scope.model.tex_width, scope.model.tex_nchannel
    return sum(math.prod(int(size[texture]) for size in sizes) for texture in scope.own("texture"))


def _contacts(scope: Scope, keys: list[str], *, everywhere: bool) -> tuple[int, str]:
    """Return the largest number of the recipe's own contacts, and where it occurs."""
    poses = [("the reference configuration", scope.mujoco.MjData(scope.model))] if everywhere else []
    poses += [(f"`{name}`", data) for name, data in at_keys(scope, keys)]
    most = 0
    where = "the reference configuration"
    for name, data in poses:
        scope.mujoco.mj_fwdPosition(scope.model, data)
        count = sum(all(geom < 0 or scope.owns("geom", int(geom)) for geom in contact.geom) for contact in data.contact)
        if count > most:
            most = count
            where = name
    return most, f", in {where}"


def _speed(scope: Scope, least: float) -> list[Fault]:
    """Return a finding if the best of several runs is too slow. Other work disturbs the best run least."""
    import numpy as np

    mujoco = scope.mujoco
    model = scope.model
    data = mujoco.MjData(model)
    best = 0.0
    for _ in range(_RUNS):
        mujoco.mj_resetData(model, data)
        mujoco.mj_step(model, data, nstep=_WARM_UP)
        steps = 0
        begin = time.thread_time()
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
