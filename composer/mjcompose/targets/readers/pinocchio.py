"""Facts of a model as Pinocchio reads it."""

import numpy as np
import pinocchio as pin
from facts import count, ends, facts, fallen, inertia, no_forces, torque
from ros2_control import commands

SHAPES = {
    "Halfspace": "plane",
    "Plane": "plane",
    "Sphere": "sphere",
    "Capsule": "capsule",
    "Ellipsoid": "ellipsoid",
    "Cylinder": "cylinder",
    "Box": "box",
    "BVHModelOBBRSS": "mesh",
    "Convex": "mesh",
    "ConvexBase": "mesh",
}


def read(file):
    robot = PinocchioRobot(file)
    return robot.facts(), robot.placed, robot.moved, robot.driven if robot.is_urdf else None


class PinocchioRobot:
    """A model of Pinocchio; `single` are the joints with one degree of freedom."""

    def __init__(self, file):
        self.file = file
        self.is_urdf = file.endswith(".urdf")
        self.model = (pin.buildModelFromUrdf if self.is_urdf else pin.buildModelFromMJCF)(file)
        self.data = self.model.createData()
        names = list(self.model.names)  # the first joint is the universe
        self.joints = {names[number]: self.model.joints[number] for number in range(1, self.model.njoints)}
        self.single = {name: joint for name, joint in self.joints.items() if joint.nv == 1}
        self.frames = [frame for frame in self.model.frames if frame.type == pin.FrameType.BODY]
        self.commands = commands(file) if self.is_urdf else {}

    def facts(self):
        found = facts(pin.__version__, composite=True, without=["friction"])
        for frame in self.frames:
            if frame.parentJoint:  # frames that are fixed to a body are part of it
                spatial = frame.placement.actInv(self.model.inertias[frame.parentJoint])
                found["bodies"][frame.name] = inertia(spatial.mass, spatial.lever, spatial.inertia)
        for name, joint in self.joints.items():
            if joint.nv == 1:
                bounds = self.bounds(joint)
                found["joints"][name] = {"range": bounds, **self.dynamics_of(joint), "force": self.most_force(joint)}
            if joint.shortname() in ("JointModelSpherical", "JointModelSphericalZYX"):
                found["joints"][name] = self.dynamics_of(joint)
        if self.is_urdf:
            del found["shapes"]
            found["commands"] = self.commands
        else:
            self.count_shapes(found)
        return found

    def bounds(self, joint):
        if joint.nq == 2:  # a joint without limits: cosine and sine
            return None
        low = float(self.model.lowerPositionLimit[joint.idx_q])
        high = float(self.model.upperPositionLimit[joint.idx_q])
        return ends(low, high) if abs(low) < 1e30 else None

    def dynamics_of(self, joint):
        at = joint.idx_v
        found = {"damping": float(self.model.damping[at]), "friction": float(self.model.upperDryFrictionLimit[at])}
        if not self.is_urdf:
            found["armature"] = float(self.model.armature[at])
        return found

    def most_force(self, joint):
        most = float(self.model.upperEffortLimit[joint.idx_v])
        is_limited = np.isfinite(most) and not (self.is_urdf and most == 1e6)
        return most if is_limited else None

    def count_shapes(self, found):
        kinds = (pin.GeometryType.VISUAL, pin.GeometryType.COLLISION)
        geometries = [pin.buildGeomFromMJCF(self.model, self.file, kind) for kind in kinds]
        shapes = {shape.name: shape for geometry in geometries for shape in geometry.geometryObjects}
        for shape in shapes.values():
            count(found, SHAPES[type(shape.geometry).__name__])

    def standing(self, pose):
        q = pin.neutral(self.model)
        for name, (value, *_) in pose["joints"].items():
            if name in self.joints:
                joint = self.joints[name]
                q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else [np.cos(value), np.sin(value)]
        for body, value in pose["free"].items():
            number = next((frame.parentJoint for frame in self.frames if frame.name == body), 0)
            if number and self.model.joints[number].nq == 7:
                at = self.model.joints[number].idx_q
                in_world = pin.XYZQUATToSE3(np.array([*value[:3], *value[4:], value[3]]))
                q[at : at + 7] = pin.SE3ToXYZQUAT(self.model.jointPlacements[number].actInv(in_world))
        return q

    def placed(self, poses):
        for pose in poses:
            pin.forwardKinematics(self.model, self.data, self.standing(pose))
            pin.updateFramePlacements(self.model, self.data)
            ats = {frame.name: self.pose_of(frame) for frame in self.frames}
            yield {name: (at.translation, at.rotation) for name, at in ats.items()}

    def pose_of(self, frame):
        return self.data.oMf[self.model.getFrameId(frame.name, pin.FrameType.BODY)]

    def moved(self, asked, steps):
        start = self.standing(asked["home"])
        return self.positions(
            fallen(start, steps, self.model.damping, no_forces, dynamics=self.dynamics, moved=self.advanced)
        )

    def driven(self, asked, steps):
        start = self.standing(asked["home"])
        drives = asked["drives"].values()
        commanded = [drive for drive in drives if drive["joint"] in self.commands and drive["joint"] in self.joints]

        def eased(q, v):
            return self.forces(commanded, q, v, "eased")

        first, _ = self.forces(commanded, start, np.zeros(self.model.nv), "full")
        end = fallen(start, steps, self.model.damping, eased, dynamics=self.dynamics, moved=self.advanced)
        return {name: first[joint.idx_v] for name, joint in self.single.items()}, self.positions(end)

    def forces(self, drives, q, v, which):
        """Return the forces of all servos and motors, and their damping."""
        forces = np.zeros(self.model.nv)
        damping = np.zeros(self.model.nv)
        for drive in drives:
            joint = self.joints[drive["joint"]]
            command = self.commands[drive["joint"]]
            at = joint.idx_v
            angle = position(joint, q)
            forces[at], damping[at] = torque(drive, which, command, angle, v[at], self.most_force(joint))
        return forces, damping

    def dynamics(self, q, v, driving):
        mass = pin.crba(self.model, self.data, q)
        force = driving - pin.nonLinearEffects(self.model, self.data, q, v) - self.model.damping * v
        return np.triu(mass) + np.triu(mass, 1).T, force

    def advanced(self, q, way):
        return pin.integrate(self.model, q, way)

    def positions(self, q):
        return {name: position(joint, q) for name, joint in self.single.items()}


def position(joint, q):
    """Return the position of a joint; one without limits has its cosine and sine."""
    at = joint.idx_q
    return q[at] if joint.nq == 1 else np.arctan2(q[at + 1], q[at])
