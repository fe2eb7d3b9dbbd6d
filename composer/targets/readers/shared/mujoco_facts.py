"""Facts of a model as a simulator has it that is made of a `mujoco.MjModel`: the names are MuJoCo's."""

import json
import sys
from importlib.metadata import version

import mujoco
import numpy as np


def write_facts(package, model, array, placed):
    """Write the facts of a model at the poses of `argv[2]` to `argv[3]`.

    `array(name)` is an array of the simulator's model, and `placed(qpos)` gives the positions and the matrices of all
    bodies, `(poses, nbody, 3)` and `(poses, nbody, 3, 3)`, for joint positions `(poses, nq)`.
    """
    with open(sys.argv[2]) as file:
        rows = [_qpos(model, pose) for pose in json.load(file)]
    names = [model.body(number).name for number in range(model.nbody)]
    xpos, xmat = map(np.asarray, placed(np.array(rows))) if rows else ([], [])
    found = {
        "version": version(package),
        "bodies": {names[number]: _body(array, number) for number in range(1, model.nbody)},
        "joints": _joints(model, array("jnt_range")),
        "actuators": _actuators(model),
        "poses": [
            {name: [at[n].tolist(), turned[n].reshape(3, 3).tolist()] for n, name in enumerate(names) if n}
            for at, turned in zip(xpos, xmat)
        ],
    }
    with open(sys.argv[3], "w") as file:
        json.dump(found, file)


def _qpos(model, pose):
    q = model.qpos0.copy()
    for name, value in pose["joints"].items():
        at = int(model.joint(name).qposadr[0])
        q[at : at + len(value)] = value
    for name, value in pose["free"].items():
        at = int(model.jnt_qposadr[model.body(name).jntadr[0]])
        q[at : at + 7] = value
    return q


def _body(array, number):
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, np.array(array("body_iquat")[number], dtype=float))
    axes = turned.reshape(3, 3)
    return {
        "mass": float(array("body_mass")[number]),
        "com": array("body_ipos")[number].tolist(),
        "inertia": (axes @ np.diag(array("body_inertia")[number]) @ axes.T).tolist(),
    }


def _joints(model, ranges):
    found = {}
    for number in range(model.njnt):
        if model.jnt_type[number] in (int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)):
            limited = bool(model.jnt_limited[number])
            found[model.joint(number).name] = {"range": ranges[number].tolist() if limited else None}
    return found


def _actuators(model):
    found = {}
    for number in range(model.nu):
        moves_joint = int(model.actuator_trntype[number]) == int(mujoco.mjtTrn.mjTRN_JOINT)
        limited = bool(model.actuator_forcelimited[number])
        found[model.actuator(number).name] = {
            "joint": model.joint(int(model.actuator_trnid[number][0])).name if moves_joint else None,
            "effort": float(model.actuator_forcerange[number][1]) if limited else None,
        }
    return found
