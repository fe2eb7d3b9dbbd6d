"""Facts of a model as MuJoCo Warp reads it: `python warp.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

model = mujoco.MjModel.from_xml_path(sys.argv[1])
poses = json.load(open(sys.argv[2]))
with wp.ScopedDevice("cpu"):
    on_device = mjw.put_model(model)
    data = mjw.make_data(model, nworld=max(len(poses), 1))


def numbers(array):
    """What a field has for the first world."""
    found = array.numpy()
    return found[0] if found.ndim and len(found) == 1 else found


mass, ipos, iquat, inertia, ranges = (
    numbers(getattr(on_device, name))
    for name in ("body_mass", "body_ipos", "body_iquat", "body_inertia", "jnt_range")
)
names = [model.body(number).name for number in range(model.nbody)]

found = {"version": version("mujoco-warp"), "bodies": {}, "joints": {}, "actuators": {}, "poses": []}
for number in range(1, model.nbody):
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, np.array(iquat[number], dtype=float))
    axes = turned.reshape(3, 3)
    found["bodies"][names[number]] = {
        "mass": float(mass[number]),
        "com": ipos[number].tolist(),
        "inertia": (axes @ np.diag(inertia[number]) @ axes.T).tolist(),
    }
for number in range(model.njnt):
    if model.jnt_type[number] >= 2:
        limited = bool(model.jnt_limited[number])
        ends = ranges[number].tolist()
        found["joints"][model.joint(number).name] = {"range": ends if limited else None}
for number in range(model.nu):
    joint = int(model.actuator_trnid[number][0])
    limited = bool(model.actuator_forcelimited[number])
    found["actuators"][model.actuator(number).name] = {
        "joint": model.joint(joint).name if int(model.actuator_trntype[number]) == 0 else None,
        "effort": float(model.actuator_forcerange[number][1]) if limited else None,
    }
rows = []
for pose in poses:
    q = model.qpos0.copy()
    for name, value in pose["joints"].items():
        at = int(model.joint(name).qposadr[0])
        q[at : at + len(value)] = value
    for name, value in pose["free"].items():
        at = int(model.jnt_qposadr[model.body(name).jntadr[0]])
        q[at : at + 7] = value
    rows.append(q)
if rows:
    with wp.ScopedDevice("cpu"):
        data.qpos = wp.array(np.array(rows), dtype=float)
        mjw.kinematics(on_device, data)
    placed, turned_to = data.xpos.numpy(), data.xmat.numpy()
    for at, turned in zip(placed, turned_to):
        found["poses"].append(
            {name: [at[n].tolist(), turned[n].reshape(3, 3).tolist()] for n, name in enumerate(names) if n}
        )
with open(sys.argv[3], "w") as file:
    json.dump(found, file)
