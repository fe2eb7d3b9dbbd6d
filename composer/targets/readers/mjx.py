"""Facts of a model as MJX reads it: `python mjx.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version

import jax
import jax.numpy as jp
import mujoco
import numpy as np
from mujoco import mjx

jax.config.update("jax_enable_x64", True)
model = mujoco.MjModel.from_xml_path(sys.argv[1])
on_device = mjx.put_model(model)
data = mjx.make_data(model)
names = [model.body(number).name for number in range(model.nbody)]

found = {"version": version("mujoco-mjx"), "bodies": {}, "joints": {}, "actuators": {}, "poses": []}
for number in range(1, model.nbody):
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, np.array(on_device.body_iquat[number]))
    axes = turned.reshape(3, 3)
    found["bodies"][names[number]] = {
        "mass": float(on_device.body_mass[number]),
        "com": np.array(on_device.body_ipos[number]).tolist(),
        "inertia": (axes @ np.diag(np.array(on_device.body_inertia[number])) @ axes.T).tolist(),
    }
for number in range(model.njnt):
    if model.jnt_type[number] >= 2:
        limited = bool(model.jnt_limited[number])
        ends = np.array(on_device.jnt_range[number]).tolist()
        found["joints"][model.joint(number).name] = {"range": ends if limited else None}
for number in range(model.nu):
    joint = int(model.actuator_trnid[number][0])
    limited = bool(model.actuator_forcelimited[number])
    found["actuators"][model.actuator(number).name] = {
        "joint": model.joint(joint).name if int(model.actuator_trntype[number]) == 0 else None,
        "effort": float(model.actuator_forcerange[number][1]) if limited else None,
    }
rows = []
for pose in json.load(open(sys.argv[2])):
    q = model.qpos0.copy()
    for name, value in pose["joints"].items():
        at = int(model.joint(name).qposadr[0])
        q[at : at + len(value)] = value
    for name, value in pose["free"].items():
        at = int(model.jnt_qposadr[model.body(name).jntadr[0]])
        q[at : at + 7] = value
    rows.append(q)
placed = jax.jit(jax.vmap(lambda q: mjx.kinematics(on_device, data.replace(qpos=q))))(jp.array(rows))
for at, turned in zip(np.array(placed.xpos), np.array(placed.xmat)):
    found["poses"].append(
        {name: [at[n].tolist(), turned[n].reshape(3, 3).tolist()] for n, name in enumerate(names) if n}
    )
with open(sys.argv[3], "w") as file:
    json.dump(found, file)
