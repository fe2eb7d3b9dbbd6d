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
    robot = PybulletRobot(file)
    return robot.facts(), robot.placed, robot.moved


class PybulletRobot:
    """The models of a file in PyBullet; `links` and `joints` are pairs of a model and a number in it."""

    def __init__(self, file):
        p.connect(p.DIRECT)
        self.file = file
        self.is_urdf = file.endswith(".urdf")
        flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
        self.models = [p.loadURDF(file, flags=flags)] if self.is_urdf else p.loadMJCF(file, flags=flags)
        self.roots = {}
        self.links = {}
        self.joints = {}
        for model in self.models:
            base = p.getBodyInfo(model)[0].decode()
            self.roots[base] = model
            self.links[base] = (model, -1)
            for number in range(p.getNumJoints(model)):
                info = p.getJointInfo(model, number)
                self.links[info[12].decode()] = (model, number)
                if info[2] in (p.JOINT_REVOLUTE, p.JOINT_PRISMATIC):
                    self.joints[info[1].decode()] = (model, number)

    def facts(self):
        found = facts(str(p.getAPIVersion()), without=["friction"])
        found["bodies"] = {name: self.body(*link) for name, link in self.links.items()}
        found["joints"] = {name: self.joint(*joint) for name, joint in self.joints.items()}
        if self.is_urdf:
            del found["shapes"]  # several shapes may be of one geom
        else:
            self.count_shapes(found)
        return found

    def body(self, model, number):
        mass, _, diagonal, com, quat, *_ = p.getDynamicsInfo(model, number)
        axes = turned(quat)
        return inertia(mass, com, axes @ np.diag(diagonal) @ axes.T)

    def joint(self, model, number):
        info = p.getJointInfo(model, number)
        bounds = [info[8], info[9]] if info[8] < info[9] else None
        found = {"range": bounds, "damping": info[6], "friction": info[7]}
        if self.is_urdf:  # it has no armature, and of MJCF it reads no forces
            found["force"] = info[10] if 0 < info[10] < 1e6 else None
        else:
            found["armature"] = 0.0
        return found

    def count_shapes(self, found):
        for model in self.models:
            for link in range(-1, p.getNumJoints(model)):
                for shape in p.getCollisionShapeData(model, link):
                    count(found, SHAPES[shape[2]])

    def stand(self, pose):
        for name, value in pose["joints"].items():
            if name in self.joints:
                p.resetJointState(*self.joints[name], value[0])
        for name, value in pose["free"].items():
            if name in self.roots:
                root = self.roots[name]
                info = p.getDynamicsInfo(root, -1)
                at = p.multiplyTransforms(value[:3], [*value[4:], value[3]], info[3], info[4])
                p.resetBasePositionAndOrientation(root, *at)

    def placed(self, poses):
        for pose in poses:
            self.stand(pose)
            yield {name: pose_of(*link) for name, link in self.links.items()}

    def moved(self, asked, steps):
        if b"<mimic" in open(self.file, "rb").read():
            return None  # its constraints cannot be switched off
        p.setGravity(*asked["gravity"])
        p.setTimeStep(STEP)
        for model in self.models:
            p.changeDynamics(model, -1, linearDamping=0, angularDamping=0)
            for link in range(-1, p.getNumJoints(model)):
                p.setCollisionFilterGroupMask(model, link, 0, 0)
        for model, number in self.joints.values():
            p.setJointMotorControl2(model, number, p.VELOCITY_CONTROL, force=0)
            p.changeDynamics(model, number, jointLowerLimit=-1e3, jointUpperLimit=1e3)
        self.stand(asked["home"])
        for _ in range(steps):
            p.stepSimulation()
        return {name: p.getJointState(*joint)[0] for name, joint in self.joints.items()}


def pose_of(model, number):
    if number >= 0:
        pos, quat = p.getLinkState(model, number, computeForwardKinematics=True)[4:6]
    else:
        info = p.getDynamicsInfo(model, -1)
        center = p.getBasePositionAndOrientation(model)
        pos, quat = p.multiplyTransforms(*center, *p.invertTransform(info[3], info[4]))
    return pos, turned(quat)
