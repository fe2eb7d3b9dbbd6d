"""Facts of a model as a program reads it: `python facts.py READER MODEL QUESTIONS.json FACTS.json`.

A reader has a function `read`, which takes the path of the model. It returns the facts without poses, and two
functions: `placed` yields the position and the rotation matrix of each body by name for poses, and `moved` returns the
joint positions after some steps from the pose `home`, or None. A reader of a program with actuators has a third one:
`driven` returns the forces of the joints at home under the `full` controls of the questions, and the joint positions
after some steps under the `eased` ones. The facts of MuJoCo are here too, for simulators that
are made from a `mujoco.MjModel`; `composer/mjcompose/targets/judge.py` compares other programs with them. The names are
MuJoCo's.
"""

import copy
import json
import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np

FREE, BALL, SLIDE, HINGE = range(4)
_JOINT = 0
_FIXED = 0
_NO_DYNAMICS = 0
_AFFINE = 1  # mjTRN_JOINT, mjGAIN_FIXED, mjDYN_NONE, mjBIAS_AFFINE
STEP = 0.0005
"""The length of a step of a motion, in seconds."""
_FREE = ("mjDSBL_CONTACT", "mjDSBL_LIMIT", "mjDSBL_EQUALITY")
_FORCE_FREE = (*_FREE, "mjDSBL_ACTUATION")
SHAPES = ("plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf")


def main(reader, model, questions, out):
    with open(questions) as file:
        asked = json.load(file)
    found = answered(asked, *runpy.run_path(reader)["read"](model))
    with open(out, "w") as file:
        json.dump(found, file)


def answered(asked: Any, found: Any, placed: Any, moved: Any, driven: Any = None) -> Any:
    """Return the facts with the poses and the motion of the questions."""
    found["poses"] = [
        {name: [np.asarray(at).tolist(), np.asarray(turned).tolist()] for name, (at, turned) in bodies.items()}
        for bodies in placed(asked["poses"])
    ]
    steps = round(asked["seconds"] / STEP)
    end = moved(asked, steps) if asked["seconds"] else None
    if end is not None:
        found["motion"] = {name: float(value) for name, value in end.items()}
    result = driven(asked, steps) if driven is not None and asked.get("drives") else None
    if result is not None:
        forces, ends_driven = result
        found["forces"] = {name: float(value) for name, value in forces.items()}
        if asked["eases"]:
            found["driven"] = {name: float(value) for name, value in ends_driven.items()}
    return found


def facts(version, **more):
    """Return empty facts."""
    return {"version": version, "bodies": {}, "joints": {}, "actuators": {}, "shapes": {}, **more}


def inertia(mass, com, matrix):
    """Return the facts of a body: mass (kg), center of mass (m) and inertia about it (kg·m²), shape (3, 3)."""
    com = np.asarray(com, dtype=float)
    matrix = np.asarray(matrix, dtype=float)
    return {"mass": float(mass), "com": com.tolist(), "inertia": matrix.tolist()}


def count(found, shape):
    found["shapes"][shape] = found["shapes"].get(shape, 0) + 1


def ends(low, high):
    """Return the range of a joint, or None if it has no limits."""
    return [float(low), float(high)] if np.isfinite([low, high]).all() else None


def rotation(quat: Any) -> Any:
    """Return the rotation matrix of a quaternion (w, x, y, z), shape (3, 3)."""
    w, x, y, z = np.asarray(quat, dtype=float)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def fallen(q, steps, damping, forces, dynamics, moved):
    """Return the positions after some steps from rest that treat damping implicitly.

    `damping` is the damping of the joints, shape (nv,). `forces(q, v)` gives the forces of servos and motors and their
    damping, `dynamics(q, v, force)` the mass matrix and the whole force, and `moved(q, way)` the positions after a
    displacement.
    """
    v = np.zeros(len(damping))
    for _ in range(steps):
        driving, resistance = forces(q, v)
        mass, force = dynamics(q, v, driving)
        v = v + STEP * np.linalg.solve(mass + STEP * np.diag(damping + resistance), force)
        q = moved(q, STEP * v)
    return q


def no_forces(q, v):
    return np.zeros(len(v)), np.zeros(len(v))


def torque(drive: Any, which: str, about: Any, q: float, v: float, most: Any = None) -> Any:
    """Return the force of a motor or a servo at its joint at `q` and `v`, at most `most`, and its damping there.

    A servo at its greatest force does not damp. `about` has the gains `kp` and `kd` and the range of the `control` that
    a program has read.
    """
    value = drive[which]["at_joint"]
    kp = about["kp"]
    kd = about["kd"]
    if about.get("control") is not None:
        value = float(np.clip(value, *about["control"]))
    error = {"force": value, "position": kp * (value - q) - kd * v, "velocity": kd * (value - v)}[drive["input"]]
    if most is not None and abs(error) > most:
        return float(np.clip(error, -most, most)), 0.0
    return error, 0.0 if drive["input"] == "force" else kd


def of_mujoco(version: Any, model: Any, array: Any, placed: Any, moved: Any, driven: Any = None) -> Any:
    """Return the same as `read`, for a simulator that is made from a `mujoco.MjModel`.

    `array(name)` is an array of the simulator's model. `placed(qpos)` gives the positions and the matrices of all
    bodies, `(poses, nbody, 3)` and `(poses, nbody, 3, 3)`, for joint positions `(poses, nq)`. `moved(qpos, steps)`
    gives the joint positions after a motion. `driven(model, qpos, full, eased, steps)` gives the forces of all degrees
    of freedom at first, `(nv,)`, and the joint positions after a motion.
    """
    bodies = [(number, name) for number in range(1, model.nbody) if (name := model.body(number).name)]
    joints = [
        (name, model.jnt_qposadr[number])
        for number in range(model.njnt)
        if model.jnt_type[number] in (HINGE, SLIDE) and (name := model.joint(number).name)
    ]

    def all_placed(poses):
        rows = [qpos(model, pose) for pose in poses]
        if rows:
            for at, turned in zip(*map(np.asarray, placed(np.array(rows)))):
                yield {name: (at[number], turned[number].reshape(3, 3)) for number, name in bodies}

    def all_moved(asked, steps):
        end = np.asarray(moved(qpos(model, asked["home"]), steps))
        return {name: end[at] for name, at in joints}

    def all_driven(asked, steps):
        controls = [np.zeros(model.nu), np.zeros(model.nu)]
        for name, drive in asked["drives"].items():
            for which, control in zip(("full", "eased"), controls):
                control[model.actuator(name).id] = drive[which]["control"]
        only = with_drives(model, asked["drives"])
        forces, end = driven(only, qpos(model, asked["home"]), *controls, steps)
        forces = np.asarray(forces)
        end = np.asarray(end)
        return {name: forces[model.jnt_dofadr[model.joint(name).id]] for name, _ in joints}, {
            name: end[at] for name, at in joints
        }

    read = {"version": version, **numbers(model, array)}
    return read, all_placed, all_moved, all_driven if driven is not None else None


def numbers(model: Any, array: Any) -> Any:
    """Return the facts without poses: of bodies, joints and actuators by name, and the count of each shape."""
    shapes = [SHAPES[kind] for kind in np.asarray(array("geom_type")).tolist() if kind < len(SHAPES)]
    bodies = {model.body(number).name: body(array, number) for number in range(1, model.nbody)}
    rows = [number for number in range(model.njnt) if model.jnt_type[number] != FREE]
    joints = {model.joint(number).name: joint(model, array, number) for number in rows}
    actuators = {model.actuator(number).name: actuator(model, array, number) for number in range(model.nu)}
    for named in (bodies, joints, actuators):
        named.pop("", None)
    counts = {kind: shapes.count(kind) for kind in sorted(set(shapes))}
    found = {"bodies": bodies, "joints": joints, "actuators": actuators, "shapes": counts}
    for number in range(model.njnt):
        name = model.joint(number).name
        if name in found["joints"] and model.jnt_type[number] in (HINGE, SLIDE) and not model.jnt_actgravcomp[number]:
            found["joints"][name]["force"] = _force(found["joints"][name], name, model, array=array)
    return found


def _force(joint, name, model, array):
    """Return the greatest force at a joint, by its own limit and the sum of its actuators' limits; None without."""
    drives = [
        actuator(model, array, number)
        for number in range(model.nu)
        if model.actuator_trntype[number] == _JOINT and model.joint(int(model.actuator_trnid[number][0])).name == name
    ]
    ends = [each.get("effort") or [None] for each in drives]
    both = [max((abs(end) for end in each), default=0) for each in ends if None not in each]
    limits = [max(map(abs, joint["effort"]))] if joint["effort"] else []
    if drives and len(both) == len(drives):
        limits.append(sum(both))
    return min(limits, default=None)


def without_forces(mujoco: Any, model: Any) -> Any:
    """Prepare a model for a motion without contacts, limits, constraints and actuators."""
    for flag in _FORCE_FREE:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, flag))
    model.opt.timestep = STEP
    return model


def with_drives(model: Any, drives: Any) -> Any:
    """Return a copy of a model without contacts, limits, constraints, and actuators other than these."""
    import mujoco  # programs that are no simulators of MuJoCo's models do not have it

    model = copy.copy(model)
    for flag in _FREE:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, flag))
    model.opt.timestep = STEP
    for number in range(model.nu):
        if model.actuator(number).name not in drives:
            model.actuator_gainprm[number] = 0
            model.actuator_biasprm[number] = 0
    return model


def qpos(model: Any, pose: Any) -> Any:
    q = model.qpos0.copy()
    for name, value in pose["joints"].items():
        at = int(model.joint(name).qposadr[0])
        q[at : at + len(value)] = value
    for name, value in pose["free"].items():
        at = int(model.jnt_qposadr[model.body(name).jntadr[0]])
        q[at : at + 7] = value
    return q


def body(array, number):
    axes = rotation(array("body_iquat")[number])
    matrix = axes @ np.diag(array("body_inertia")[number]) @ axes.T
    return inertia(array("body_mass")[number], array("body_ipos")[number], matrix)


def joint(model, array, number):
    dof = int(model.jnt_dofadr[number])
    found = {
        "damping": float(array("dof_damping")[dof]),
        "friction": float(array("dof_frictionloss")[dof]),
        "armature": float(array("dof_armature")[dof]),
        "stiffness": float(array("jnt_stiffness")[number]),
    }
    if model.jnt_type[number] in (HINGE, SLIDE):
        ranges = array("jnt_range")[number]
        forces = array("jnt_actfrcrange")[number]
        found["range"] = np.asarray(ranges).tolist() if model.jnt_limited[number] else None
        found["effort"] = np.asarray(forces).tolist() if model.jnt_actfrclimited[number] else None
    return found


def actuator(model, array, number):
    """Return an actuator's facts at its joint: gains and greatest forces through the gear, of a motor or a servo."""
    if model.actuator_trntype[number] != _JOINT:
        return {"joint": None}
    about = {"joint": model.joint(int(model.actuator_trnid[number][0])).name}
    if model.actuator_gaintype[number] != _FIXED or model.actuator_dyntype[number] != _NO_DYNAMICS:
        return about
    gear = float(array("actuator_gear")[number][0])
    gain, bias = (np.asarray(array(name)[number], dtype=float) for name in ("actuator_gainprm", "actuator_biasprm"))
    affine = model.actuator_biastype[number] == _AFFINE
    about |= {"kp": -bias[1] * gear**2 if affine else 0.0, "kd": -bias[2] * gear**2 if affine else 0.0}
    is_limited = model.actuator_ctrllimited[number]
    control = np.asarray(array("actuator_ctrlrange")[number], dtype=float)
    if gear:
        at_joint = 1 / gear if affine else gain[0] * gear
        about["control"] = np.sort(control * at_joint).tolist() if is_limited else None
    ends = np.array([-np.inf, np.inf])
    if model.actuator_forcelimited[number]:
        ends = np.asarray(array("actuator_forcerange")[number], dtype=float)
    if is_limited and not affine:
        ends = np.clip(ends, *np.sort(control * gain[0]))
    ends = np.sort(ends * gear) if gear else ends
    about["effort"] = [float(end) if np.isfinite(end) else None for end in ends]
    return about


if __name__ == "__main__":
    # Not the folder of the readers: its `warp.py` and others would stand for the packages of these names.
    sys.path.append(str(Path(__file__).parent))
    main(*sys.argv[1:])
