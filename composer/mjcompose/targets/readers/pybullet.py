"""Facts of a model as PyBullet reads it: `python pybullet.py MODEL POSES.json FACTS.json`."""

import json
import sys

import numpy as np
import pybullet as p

p.connect(p.DIRECT)
STEP = 0.0005
SHAPES = {p.GEOM_SPHERE: "sphere", p.GEOM_BOX: "box", p.GEOM_CYLINDER: "cylinder", p.GEOM_MESH: "mesh",
          p.GEOM_PLANE: "plane", p.GEOM_CAPSULE: "capsule"}  # fmt: skip
flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
urdf = sys.argv[1].endswith(".urdf")
models = [p.loadURDF(sys.argv[1], flags=flags)] if urdf else p.loadMJCF(sys.argv[1], flags=flags)


def turned(quat):
    return np.array(p.getMatrixFromQuaternion(quat)).reshape(3, 3)


found = {
    "version": str(p.getAPIVersion()), "bodies": {}, "joints": {}, "actuators": {}, "poses": [], "shapes": {},
}  # fmt: skip
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
            found["joints"][info[1].decode()] = {
                "range": [info[8], info[9]] if bounded else None,
                "damping": info[6],
                "friction": info[7],
                "armature": 0.0,  # it has none
                "force": info[10] if 0 < info[10] < 1e6 else None,
            }
    for link in range(-1, p.getNumJoints(model)):
        for shape in p.getCollisionShapeData(model, link):
            found["shapes"][SHAPES[shape[2]]] = found["shapes"].get(SHAPES[shape[2]], 0) + 1
for name, (model, number) in links.items():
    info = p.getDynamicsInfo(model, number)
    axes = turned(info[4])
    found["bodies"][name] = {
        "mass": info[0], "com": list(info[3]), "inertia": (axes @ np.diag(info[2]) @ axes.T).tolist(),
    }  # fmt: skip
if urdf:
    del found["shapes"]  # several shapes may be of one geom
for joint in found["joints"].values():
    joint.pop("armature" if urdf else "force")  # URDF has no armature, and of MJCF it reads no forces
asked = json.load(open(sys.argv[2]))


def stand(pose):
    for name, value in pose["joints"].items():
        if name in joints:
            p.resetJointState(*joints[name], value[0])
    for name, value in pose["free"].items():
        if name in roots:
            info = p.getDynamicsInfo(roots[name], -1)
            at = p.multiplyTransforms(value[:3], [*value[4:], value[3]], info[3], info[4])
            p.resetBasePositionAndOrientation(roots[name], *at)


for pose in asked["poses"]:
    stand(pose)
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
# The constraints of `<mimic>` cannot be switched off for a motion.
if asked["seconds"] and b"<mimic" not in open(sys.argv[1], "rb").read():
    found["motion"], found["without"] = {}, ["friction"]
    p.setGravity(*asked["gravity"])
    p.setTimeStep(STEP)
    for model in models:
        p.changeDynamics(model, -1, linearDamping=0, angularDamping=0)
        for link in range(-1, p.getNumJoints(model)):
            p.setCollisionFilterGroupMask(model, link, 0, 0)
    for model, number in joints.values():
        p.setJointMotorControl2(model, number, p.VELOCITY_CONTROL, force=0)
        p.changeDynamics(model, number, jointLowerLimit=-1e3, jointUpperLimit=1e3)
    stand(asked["home"])
    for _ in range(round(asked["seconds"] / STEP)):
        p.stepSimulation()
    for name, joint in joints.items():
        found["motion"][name] = p.getJointState(*joint)[0]
json.dump(found, open(sys.argv[3], "w"))
