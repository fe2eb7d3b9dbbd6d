"""The check `budget`: limits of a model's cost."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import Annotated, Any, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.language.check import Check
from mjcompose.language.forms.model import AnyOf
from mjcompose.language.forms.scalars import BYTES, Items, Name, NotNegative, Positive, Scaled
from mjcompose.verify.checks.check import Scope, at_keys, failed, keys_named

_MOST = ("geoms", "faces", "meshes", "textures", "bytes", "contacts", "steps_per_second")
_BYTES = Annotated[float, Scaled(BYTES, ge=0)]


class Budget(Check):
    """The model stays within these limits of size and speed."""

    word: ClassVar = "budget"
    example: ClassVar = "{faces: 50000}"
    rules: ClassVar = (AnyOf(*_MOST, lacks="limits nothing", advice="write for instance `faces: 50000`"),)
    instead: ClassVar = {"keys": "key"}

    geoms: NotNegative | None = None
    """the largest number of geoms"""
    faces: NotNegative | None = None
    """the largest number of triangles of all meshes together"""
    meshes: _BYTES | None = None
    """the largest memory of all meshes together, in bytes"""
    textures: _BYTES | None = None
    """the largest memory of all textures together, in bytes"""
    bytes: _BYTES | None = None
    """the largest size of all files of the model together, in bytes"""
    contacts: NotNegative | None = None
    """the largest number of contacts in a keyframe, or in the reference configuration"""
    steps_per_second: Positive | None = None
    """the smallest number of steps per second, in one thread on this machine"""
    key: Annotated[tuple[Annotated[str, Name("key", glob=True)], ...], Items(1, single=True)] = ()
    """the keyframes in which to count contacts; by default all, and the reference configuration"""


KIND = Budget

_WARM_UP = 20
_SECONDS = 0.2
_RUNS = 3
_OF_A_MESH = {"vert": 12, "normal": 12, "texcoord": 8, "face": 36}
"""Bytes of each: two or three single-precision numbers, or nine indices for a face."""
_SHOWN_SPEED = 2
"""Digits: the speed differs from run to run."""


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Return one finding for each exceeded limit."""
    keys = keys_named(scope, asked["key"])
    faces = scope.model.mesh_facenum
    counted: Mapping[str, Callable[[], tuple[int, str]]] = {
        "geoms": lambda: (len(list(scope.own("geom"))), ""),
        "meshes": lambda: (_meshes(scope), " bytes in memory"),
        "faces": lambda: (sum(int(faces[mesh]) for mesh in scope.own("mesh")), ", in all meshes together"),
        "bytes": lambda: (int(asked["size"]), ", in all files of the model together"),
        "textures": lambda: (_textures(scope), " bytes in memory"),
        "contacts": lambda: _contacts(scope, keys, everywhere=not asked["key"]),
    }
    found: list[Fault] = []
    for name, count in counted.items():
        if (most := asked[name]) is None:
            continue
        value, words = count()
        scope.found(name, value)
        if value > most:
            found.append(failed(f"`{name}` is {value}{words}", f"at most {most:.15g}", str(value), name))
    if asked["steps_per_second"] is not None:
        found += _speed(scope, asked["steps_per_second"])
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
