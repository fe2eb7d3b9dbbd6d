"""Facts of a model as PyBullet reads it."""

import numpy as np
import pybullet as p
from facts import STEP, count, facts, inertia, rotation

SHAPES = {
    p.GEOM_SPHERE: "sphere",
    p.GEOM_BOX: "box",
    p.GEOM_CYLINDER: "cylinder",
    p.GEOM_MESH: "mesh",
    p.GEOM_PLANE: "plane",
    p.GEOM_CAPSULE: "capsule",
}


def turned(quat):
    return rotation([quat[3], *quat[:3]])


def read(file):
    p.connect(p.DIRECT)
    flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
    urdf = file.endswith(".urdf")
    models = [p.loadURDF(file, flags=flags)] if urdf else p.loadMJCF(file, flags=flags)
    found = facts(str(p.getAPIVersion()), without=["friction"])
    links = {}
    joints = {}
    roots = {}
    for model in models:
        base = p.getBodyInfo(model)[0].decode()
        roots[base] = model
        links[base] = (model, -1)
        for number in range(p.getNumJoints(model)):
            info = p.getJointInfo(model, number)
            name = info[1].decode()
            links[info[12].decode()] = (model, number)
            if info[2] in (p.JOINT_REVOLUTE, p.JOINT_PRISMATIC):
                joints[name] = (model, number)
                bounds = [info[8], info[9]] if info[8] < info[9] else None
                found["joints"][name] = {"range": bounds, "damping": info[6], "friction": info[7]}
                if urdf:  # it has no armature, and of MJCF it reads no forces
                    found["joints"][name]["force"] = info[10] if 0 < info[10] < 1e6 else None
                else:
                    found["joints"][name]["armature"] = 0.0
        for link in range(-1, p.getNumJoints(model)):
            for shape in p.getCollisionShapeData(model, link):
                count(found, SHAPES[shape[2]])
    for name, (model, number) in links.items():
        mass, _, diagonal, com, quat, *_ = p.getDynamicsInfo(model, number)
        axes = turned(quat)
        found["bodies"][name] = inertia(mass, com, axes @ np.diag(diagonal) @ axes.T)
    if urdf:
        del found["shapes"]  # several shapes may be of one geom

    def stand(pose):
        for name, value in pose["joints"].items():
            if name in joints:
                p.resetJointState(*joints[name], value[0])
        for name, value in pose["free"].items():
            if name in roots:
                info = p.getDynamicsInfo(roots[name], -1)
                at = p.multiplyTransforms(value[:3], [*value[4:], value[3]], info[3], info[4])
                p.resetBasePositionAndOrientation(roots[name], *at)

    def at(model, number):
        if number >= 0:
            pos, quat = p.getLinkState(model, number, computeForwardKinematics=True)[4:6]
        else:
            info = p.getDynamicsInfo(model, -1)
            center = p.getBasePositionAndOrientation(model)
            pos, quat = p.multiplyTransforms(*center, *p.invertTransform(info[3], info[4]))
        return pos, turned(quat)

    def placed(poses):
        for pose in poses:
            stand(pose)
            yield {name: at(*link) for name, link in links.items()}

    def moved(asked, steps):
        if b"<mimic" in open(file, "rb").read():
            return None  # its constraints cannot be switched off
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
        for _ in range(steps):
            p.stepSimulation()
        return {name: p.getJointState(*joint)[0] for name, joint in joints.items()}

    return found, placed, moved
