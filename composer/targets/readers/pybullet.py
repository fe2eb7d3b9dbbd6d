"""Facts of a model as PyBullet reads it: `python pybullet.py MODEL POSES.json FACTS.json`."""

import json
import sys

import numpy as np
import pybullet as p

p.connect(p.DIRECT)
flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
if sys.argv[1].endswith(".urdf"):
    models = [p.loadURDF(sys.argv[1], flags=flags)]
else:
    models = p.loadMJCF(sys.argv[1], flags=flags)


def turned(quat):
    return np.array(p.getMatrixFromQuaternion(quat)).reshape(3, 3)


found = {"version": str(p.getAPIVersion()), "bodies": {}, "joints": {}, "actuators": {}, "poses": []}
links, joints, roots = {}, {}, {}
for model in models:
    base = p.getBodyInfo(model)[0].decode()
    roots[base] = model
    links[base] = (model, -1)
    for number in range(p.getNumJoints(model)):
        info = p.getJointInfo(model, number)
        links[info[12].decode()] = (model, number)
        if info[2] in (p.JOINT_REVOLUTE, p.JOINT_PRISMATIC):
            joints[info[1].decode()] = (model, number)
            bounded = info[8] < info[9]
            found["joints"][info[1].decode()] = {"range": [info[8], info[9]] if bounded else None}
for name, (model, number) in links.items():
    info = p.getDynamicsInfo(model, number)
    axes = turned(info[4])
    found["bodies"][name] = {
        "mass": info[0],
        "com": list(info[3]),
        "inertia": (axes @ np.diag(info[2]) @ axes.T).tolist(),
    }
for pose in json.load(open(sys.argv[2])):
    for name, value in pose["joints"].items():
        if name in joints:
            p.resetJointState(*joints[name], value[0])
    for name, value in pose["free"].items():
        if name in roots:
            info = p.getDynamicsInfo(roots[name], -1)
            at = p.multiplyTransforms(value[:3], [*value[4:], value[3]], info[3], info[4])
            p.resetBasePositionAndOrientation(roots[name], *at)
    row = {}
    for name, (model, number) in links.items():
        if number >= 0:
            state = p.getLinkState(model, number, computeForwardKinematics=True)
            at, quat = state[4], state[5]
        else:
            at, quat = p.getBasePositionAndOrientation(model)
            info = p.getDynamicsInfo(model, -1)
            at, quat = p.multiplyTransforms(at, quat, *p.invertTransform(info[3], info[4]))
        row[name] = [list(at), turned(quat).tolist()]
    found["poses"].append(row)
with open(sys.argv[3], "w") as file:
    json.dump(found, file)
