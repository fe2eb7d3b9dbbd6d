"""Compare what a consumer reads with the model: masses, inertia, poses, limits. Runs in MuJoCo's child process."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

HINGE, SLIDE, FREE = 3, 2, 0


def poses_of(_mujoco: object, model: Any, count: int) -> list[dict[str, Any]]:
    """Return `count` random configurations. It is called by `composer.engine.call`."""
    return poses(model, count)


def judged(mujoco: Any, model: Any, question: dict[str, Any]) -> list[str]:
    """Return the differences between the `facts` and the model at the `poses`, in words.

    It is called by `composer.engine.call`.
    """
    return list(faults(mujoco, model, question["facts"], question["poses"], question["single"]))


def poses(model: Any, count: int = 50, seed: int = 1) -> list[dict[str, Any]]:
    """Return random configurations: joint positions in their limits (rad, m), and poses of free bodies.

    Each has `joints`, a list of numbers by joint name, and `free`, a position (m) and a quaternion (w, x, y, z) by
    body name.
    """
    draw = np.random.default_rng(seed)
    found: list[dict[str, Any]] = []
    for _ in range(count):
        joints: dict[str, list[float]] = {}
        free: dict[str, list[float]] = {}
        for number in range(model.njnt):
            kind = int(model.jnt_type[number])
            if kind in (SLIDE, HINGE) and model.joint(number).name:
                low, high = model.jnt_range[number] if model.jnt_limited[number] else (-1.0, 1.0)
                joints[model.joint(number).name] = [float(draw.uniform(low, high))]
            elif kind == FREE and model.body(int(model.jnt_bodyid[number])).name:
                turned = draw.normal(size=4)
                turned /= np.linalg.norm(turned)
                at = draw.uniform(-1, 1, 3)
                free[model.body(int(model.jnt_bodyid[number])).name] = [*at.tolist(), *turned.tolist()]
        found.append({"joints": joints, "free": free})
    return found


def faults(
    mujoco: Any, model: Any, facts: dict[str, Any], at: list[dict[str, Any]], single: bool
) -> Iterator[str]:
    """Yield the differences between what a consumer read and the model.

    `single` allows for a consumer that computes in single precision.
    """
    tolerance = 1e-4 if single else 1e-9
    yield from _masses(mujoco, model, facts, 2e-6 if single else 1e-9)
    yield from _limits(model, facts, 1e-5 if single else 1e-9)
    yield from _poses(mujoco, model, facts, at, tolerance)
    if facts.get("actuators"):
        yield from _actuators(model, facts)


def _masses(mujoco: Any, model: Any, facts: dict[str, Any], tolerance: float) -> Iterator[str]:
    for body in range(1, model.nbody):
        if facts.get("composite") and model.body_weldid[body] != body:
            continue  # is part of what it is fixed to
        name = model.body(body).name
        if not name:
            continue  # each program calls it as it likes
        if name not in facts["bodies"]:
            yield f"the body `{name}` is missing"
            continue
        parts = [body]
        if facts.get("composite"):
            parts = [each for each in range(model.nbody) if model.body_weldid[each] == body]
        mass, com, inertia = _composite(mujoco, model, body, parts)
        read = facts["bodies"][name]
        if abs(read["mass"] - mass) > tolerance * max(1.0, mass):
            yield f"the mass of `{name}` is {read['mass']:.9g}, not {mass:.9g}"
        elif mass > 0 and np.abs(np.array(read["com"]) - com).max() > max(tolerance, 1e-7):
            yield f"the centre of mass of `{name}` is at {_shown(read['com'])}, not {_shown(com)}"
        elif (
            mass > 0
            and np.abs(np.array(read["inertia"]) - inertia).max() > tolerance * np.abs(inertia).max() + 1e-12
        ):
            yield f"the inertia of `{name}` is {_shown(read['inertia'])}, not {_shown(inertia)}"


def _composite(mujoco: Any, model: Any, body: int, parts: list[int]) -> tuple[float, Any, Any]:
    """Return mass (kg), centre (m) and inertia about the centre (kg·m²) of a body and everything fixed to it.

    Centre and inertia are in the frame of the body. Their shapes are (3,) and (3, 3).
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    frame, origin = data.xmat[body].reshape(3, 3), data.xpos[body]
    masses = model.body_mass[parts]
    mass = float(masses.sum())
    if mass == 0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    centre = (masses[:, None] * data.xipos[parts]).sum(axis=0) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        axes = data.ximat[part].reshape(3, 3)
        off = data.xipos[part] - centre
        inertia += axes @ np.diag(model.body_inertia[part]) @ axes.T
        inertia += model.body_mass[part] * (off @ off * np.eye(3) - np.outer(off, off))
    return mass, frame.T @ (centre - origin), frame.T @ inertia @ frame


def _limits(model: Any, facts: dict[str, Any], tolerance: float) -> Iterator[str]:
    for number in range(model.njnt):
        if int(model.jnt_type[number]) not in (SLIDE, HINGE):
            continue
        name = model.joint(number).name
        if not name:
            continue
        if name not in facts["joints"]:
            yield f"the joint `{name}` is missing"
            continue
        read = facts["joints"][name]["range"]
        limited = bool(model.jnt_limited[number])
        if limited != (read is not None):
            yield f"the joint `{name}` has the limits {read}, not {model.jnt_range[number] if limited else None}"
        elif limited and np.abs(np.array(read) - model.jnt_range[number]).max() > tolerance:
            yield f"the joint `{name}` has the limits {read}, not {model.jnt_range[number]}"


def _actuators(model: Any, facts: dict[str, Any]) -> Iterator[str]:
    """Yield actuators that act on another joint than in the model, or with another greatest force."""
    for name, read in facts["actuators"].items():
        actuator = model.actuator(name)
        joint = model.joint(int(actuator.trnid[0])).name
        if read["joint"] not in (joint, None):
            yield f"the actuator `{name}` acts on {read['joint']}, not on {joint}"
        limited = bool(model.actuator_forcelimited[actuator.id])
        if limited and read["effort"] != actuator.forcerange[1]:
            yield f"the actuator `{name}` gives {read['effort']}, not {actuator.forcerange[1]}"


def _poses(
    mujoco: Any, model: Any, facts: dict[str, Any], at: list[dict[str, Any]], tolerance: float
) -> Iterator[str]:
    data = mujoco.MjData(model)
    worst, where = 0.0, ""
    for asked, read in zip(at, facts["poses"], strict=True):
        mujoco.mj_resetData(model, data)
        for name, value in asked["joints"].items():
            data.joint(name).qpos[:] = value
        for name, value in asked["free"].items():
            start = int(model.jnt_qposadr[model.body(name).jntadr[0]])
            data.qpos[start : start + 7] = value
        mujoco.mj_kinematics(model, data)
        for body in range(1, model.nbody):
            name = model.body(body).name
            if name and name in read:
                off = max(
                    float(np.abs(np.array(read[name][0]) - data.xpos[body]).max()),
                    float(np.abs(np.array(read[name][1]) - data.xmat[body].reshape(3, 3)).max()),
                )
                if off > worst:
                    worst, where = off, name
            elif name and not facts.get("composite"):
                yield f"the body `{name}` has no pose"
                return
    if worst > tolerance:
        yield f"the pose of `{where}` is up to {worst:.3g} off"


def _shown(numbers: Any) -> str:
    return " ".join(f"{each:.6g}" for each in np.asarray(numbers).ravel())
