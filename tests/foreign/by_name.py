"""Two compiled models and their motion, compared by name with nothing but MuJoCo.

What a model is made of is found by kind and name in both. An element without a name is known by its body and its place
among the nameless of its kind there. Names that only one of the two has are told, unless the caller leaves them out.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

# The fields that decide how a model moves and what its sensors measure, by kind. Ids are compared by what they name.
_FIELDS = {
    "body": "pos quat mass inertia ipos iquat gravcomp",
    "joint": "type pos axis stiffness range limited solref solimp margin group",
    "dof": "armature damping frictionloss",
    "geom": "type size pos quat friction solref solimp solmix margin gap contype conaffinity condim priority group fluid",
    "site": "type size pos quat group",
    "actuator": "trntype dyntype gaintype biastype dynprm gainprm biasprm ctrlrange ctrllimited forcerange forcelimited gear",
    "sensor": "type datatype needstage objtype reftype dim cutoff noise",
    "tendon": "stiffness damping frictionloss range limited lengthspring solref_lim solimp_lim margin armature",
    "equality": "type active0 solref solimp data",
    "camera": "pos quat mode fovy",
    "light": "pos dir mode type",
}
_ROUNDING = 1e-9
_OF_BODY = {"joint", "geom", "site", "camera", "light"}


@dataclass(frozen=True)
class LeftOut:
    """What the comparison leaves out, as patterns of whole names: elements, and names of which there need be none.

    Without `tree`, a body may have another parent and another pose there: its pose in the world counts, in motion.
    """

    elements: str = "$."
    names: str = "$."
    tree: bool = True


def differences(first: mujoco.MjModel, second: mujoco.MjModel, left_out: LeftOut) -> Iterator[str]:
    """What is otherwise in the second, one line each."""
    for kind in ("body", "joint", "geom", "site", "actuator", "sensor", "tendon", "equality", "camera", "light"):
        ours = _names(first, kind, left_out)
        theirs = _names(second, kind, left_out)
        for name in sorted(ours.keys() ^ theirs.keys()):
            yield f"{kind} `{name}` is only in the {'first' if name in ours else 'second'}"
        for name in sorted(ours.keys() & theirs.keys()):
            named = (name, ours[name], theirs[name])
            yield from _different_fields(first, second, kind, named, tree=left_out.tree)
            if left_out.tree:
                yield from _different_links(first, second, kind, named)
    for name in (
        "timestep",
        "impratio",
        "cone",
        "integrator",
        "density",
        "viscosity",
        "gravity",
        "solver",
        "disableflags",
    ):
        if not np.array_equal(getattr(first.opt, name), getattr(second.opt, name)):
            yield f"option {name} is {getattr(first.opt, name)} and {getattr(second.opt, name)}"
    if not np.isclose(first.body_mass.sum(), second.body_mass.sum(), rtol=_ROUNDING):
        yield f"the masses are {first.body_mass.sum()} and {second.body_mass.sum()} kg in all"


def driven_apart(
    first: mujoco.MjModel, second: mujoco.MjModel, pose: Mapping[str, Sequence[float]], seconds: float = 1.0
) -> float:
    """How far two bodies of one name are from each other, in meters or in turns, after a motion under the same controls."""
    states = [_posed(model, pose) for model in (first, second)]
    random = np.random.default_rng(7)
    for _ in range(round(seconds / first.opt.timestep / 25)):
        drive = {first.actuator(index).name: random.uniform() for index in range(first.nu)}
        for model, data in zip((first, second), states, strict=True):
            _control(model, data, drive)
            mujoco.mj_step(model, data, 25)
    apart = 0.0
    for index in range(first.nbody):
        name = first.body(index).name
        other = mujoco.mj_name2id(second, mujoco.mjtObj.mjOBJ_BODY, name)
        if other >= 0:
            apart = max(apart, float(np.abs(states[0].xpos[index] - states[1].xpos[other]).max()))
            apart = max(apart, float(np.abs(states[0].xmat[index] - states[1].xmat[other]).max()))
    moved = float(np.abs(states[0].qpos - _posed(first, pose).qpos).max())
    assert moved > 0.01, "nothing moves, so the comparison says nothing"
    return apart


def _names(model: mujoco.MjModel, kind: str, left_out: LeftOut) -> dict[str, int]:
    """Each element's number by its name; a nameless one is called by its body and its place there."""
    access: Callable[[int], object] = getattr(model, "equality" if kind == "equality" else kind)
    counts: dict[str, int] = defaultdict(int)
    names: dict[str, int] = {}
    for index in range(getattr(model, _COUNTS[kind])):
        name = access(index).name  # type: ignore[attr-defined]
        if re.fullmatch(left_out.elements, name):
            continue
        if not name or re.fullmatch(left_out.names, name):
            owner = model.body(getattr(model, f"{_PREFIX[kind]}_bodyid")[index]).name if kind in _OF_BODY else ""
            counts[owner] += 1
            name = f"{owner}#{counts[owner]}"
        names[name] = index
    return names


_COUNTS = {
    "body": "nbody",
    "joint": "njnt",
    "geom": "ngeom",
    "site": "nsite",
    "actuator": "nu",
    "sensor": "nsensor",
    "tendon": "ntendon",
    "equality": "neq",
    "camera": "ncam",
    "light": "nlight",
}
_PREFIX = {
    "body": "body",
    "joint": "jnt",
    "dof": "dof",
    "geom": "geom",
    "site": "site",
    "actuator": "actuator",
    "sensor": "sensor",
    "tendon": "tendon",
    "equality": "eq",
    "camera": "cam",
    "light": "light",
}


def _different_fields(
    first: mujoco.MjModel, second: mujoco.MjModel, kind: str, named: tuple[str, int, int], *, tree: bool
) -> Iterator[str]:
    name, ours, theirs = named
    for attribute in _FIELDS[kind].split():
        if kind == "body" and attribute in ("pos", "quat") and not tree:
            continue
        # A body without mass has no place of it.
        if kind == "body" and attribute in ("ipos", "iquat") and first.body_mass[ours] == second.body_mass[theirs] == 0:
            continue
        one = _value(first, kind, attribute, ours)
        other = _value(second, kind, attribute, theirs)
        if one.shape != other.shape or not _same(attribute, one, other):
            yield f"{kind} `{name}`: {attribute} is {one} and {other}"
    if kind == "joint":
        degrees = (name, first.jnt_dofadr[ours], second.jnt_dofadr[theirs])
        yield from _different_fields(first, second, "dof", degrees, tree=tree)


def _value(model: mujoco.MjModel, kind: str, attribute: str, index: int) -> np.ndarray:
    return np.asarray(getattr(model, f"{_PREFIX[kind]}_{attribute}")[index], dtype=float)


def _same(attribute: str, one: np.ndarray, other: np.ndarray) -> bool:
    if attribute in ("quat", "iquat"):
        return bool(np.allclose(one, other, atol=_ROUNDING) or np.allclose(one, -other, atol=_ROUNDING))
    return bool(np.allclose(one, other, rtol=_ROUNDING, atol=1e-12))


def _different_links(
    first: mujoco.MjModel, second: mujoco.MjModel, kind: str, named: tuple[str, int, int]
) -> Iterator[str]:
    """The bodies, joints and tendons that an element names."""
    name, ours, theirs = named
    one = _linked(first, kind, ours)
    other = _linked(second, kind, theirs)
    if one != other:
        yield f"{kind} `{name}` belongs to {one} and {other}"


def _linked(model: mujoco.MjModel, kind: str, index: int) -> str:
    if kind == "body":
        return str(model.body(model.body_parentid[index]).name)
    if kind in _OF_BODY:
        return str(model.body(getattr(model, f"{_PREFIX[kind]}_bodyid")[index]).name)
    if kind == "actuator":
        transmission = mujoco.mjtTrn(model.actuator_trntype[index])
        kinds = {mujoco.mjtTrn.mjTRN_JOINT: "joint", mujoco.mjtTrn.mjTRN_TENDON: "tendon"}
        target = int(model.actuator_trnid[index][0])
        return str(getattr(model, kinds[transmission])(target).name) if transmission in kinds else ""
    if kind == "sensor":
        return mujoco.mj_id2name(model, int(model.sensor_objtype[index]), int(model.sensor_objid[index])) or ""
    if kind == "equality":
        objects = (model.eq_obj1id[index], model.eq_obj2id[index])
        return " ".join(mujoco.mj_id2name(model, int(model.eq_objtype[index]), int(each)) or "" for each in objects)
    return ""


def _posed(model: mujoco.MjModel, pose: Mapping[str, Sequence[float]]) -> mujoco.MjData:
    data = mujoco.MjData(model)
    for joint, numbers in pose.items():
        data.joint(joint).qpos[:] = numbers
    mujoco.mj_forward(model, data)
    return data


def _control(model: mujoco.MjModel, data: mujoco.MjData, drive: Mapping[str, float]) -> None:
    """Each control at a share of its range; of a motor without one, of -1 to 1."""
    for name, share in drive.items():
        index = model.actuator(name).id
        low, high = model.actuator_ctrlrange[index] if model.actuator_ctrllimited[index] else (-1.0, 1.0)
        data.ctrl[index] = low + share * (high - low)
