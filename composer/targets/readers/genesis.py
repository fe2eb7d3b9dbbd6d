"""Facts of a model as Genesis reads it: `python genesis.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version

import genesis as gs
import numpy as np

gs.init(backend=gs.cpu, precision="64", logging_level="error")
scene = gs.Scene(show_viewer=False)
# Not aligned: the origin of a free body stays where the model has it.
entity = scene.add_entity(gs.morphs.MJCF(file=sys.argv[1], align=False))
scene.build()


def turned(quat):
    w, x, y, z = np.asarray(quat, dtype=float)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


found = {"version": version("genesis-world"), "bodies": {}, "joints": {}, "actuators": {}, "poses": []}
links = {link.name: link for link in entity.links if link.name != "world"}
for name, link in links.items():
    axes = turned(link.desc.inertial_quat)
    found["bodies"][name] = {
        "mass": float(link.desc.mass),
        "com": np.asarray(link.desc.inertial_pos, dtype=float).tolist(),
        "inertia": (axes @ np.asarray(link.desc.inertia, dtype=float) @ axes.T).tolist(),
    }
joints = {joint.name: joint for joint in entity.joints if joint.n_qs == 1}
low, high = (each.cpu().numpy().reshape(-1) for each in entity.get_dofs_limit())
for name, joint in joints.items():
    ends = [float(each[joint.dofs_idx_local[0]]) for each in (low, high)]
    found["joints"][name] = {"range": ends if np.isfinite(ends).all() else None}
start = entity.get_qpos().cpu().numpy().reshape(-1)
free = {joint.link.name: joint for joint in entity.joints if joint.type == gs.JOINT_TYPE.FREE}
for pose in json.load(open(sys.argv[2])):
    q = start.copy()
    for name, value in pose["joints"].items():
        if name in joints:
            q[joints[name].qs_idx_local] = value
    for name, value in pose["free"].items():
        if name in free:
            q[free[name].qs_idx_local] = value
    entity.set_qpos(q)
    at = entity.get_links_pos().cpu().numpy().reshape(-1, 3)
    quats = entity.get_links_quat().cpu().numpy().reshape(-1, 4)
    row = {}
    for name, link in links.items():
        row[name] = [at[link.idx_local].tolist(), turned(quats[link.idx_local]).tolist()]
    found["poses"].append(row)
with open(sys.argv[3], "w") as file:
    json.dump(found, file)
