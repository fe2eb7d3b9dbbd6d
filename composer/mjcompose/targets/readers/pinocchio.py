"""Facts of a model as Pinocchio reads it."""

import numpy as np
import pinocchio as pin
from facts import count, ends, facts, fallen, inertia, torque
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
    urdf = file.endswith(".urdf")
    model = (pin.buildModelFromUrdf if urdf else pin.buildModelFromMJCF)(file)
    data = model.createData()
    names = list(model.names)

    def dynamics_of(joint, limited=True):
        at = joint.idx_v
        found = {"damping": float(model.damping[at]), "friction": float(model.upperDryFrictionLimit[at])}
        if not urdf:
            found["armature"] = float(model.armature[at])
        if limited:
            most = float(model.upperEffortLimit[at])
            found["force"] = most if np.isfinite(most) and not (urdf and most == 1e6) else None
        return found

    found = facts(pin.__version__, composite=True, without=["friction"])
    frames = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    for frame in frames:
        if frame.parentJoint:  # frames that are fixed to a body are part of it
            spatial = frame.placement.actInv(model.inertias[frame.parentJoint])
            found["bodies"][frame.name] = inertia(spatial.mass, spatial.lever, spatial.inertia)
    for number in range(1, model.njoints):
        joint = model.joints[number]
        if joint.nq == 2 and joint.nv == 1:  # a joint without limits: cosine and sine
            found["joints"][names[number]] = {"range": None, **dynamics_of(joint)}
        if joint.nq == 1:
            low = float(model.lowerPositionLimit[joint.idx_q])
            high = float(model.upperPositionLimit[joint.idx_q])
            bounds = ends(low, high) if abs(low) < 1e30 else None
            found["joints"][names[number]] = {"range": bounds, **dynamics_of(joint)}
        if joint.shortname() in ("JointModelSpherical", "JointModelSphericalZYX"):
            found["joints"][names[number]] = dynamics_of(joint, limited=False)
    if urdf:
        del found["shapes"]
        found["commands"] = commands(file)
    else:
        kinds = (pin.GeometryType.VISUAL, pin.GeometryType.COLLISION)
        shapes = [each for kind in kinds for each in pin.buildGeomFromMJCF(model, file, kind).geometryObjects]
        for shape in {each.name: each for each in shapes}.values():
            count(found, SHAPES[type(shape.geometry).__name__])

    def standing(pose):
        q = pin.neutral(model)
        for name, (value, *_) in pose["joints"].items():
            if name in names:
                joint = model.joints[names.index(name)]
                q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else [np.cos(value), np.sin(value)]
        for body, value in pose["free"].items():
            joint = next((f.parentJoint for f in frames if f.name == body), 0)
            if joint and model.joints[joint].nq == 7:
                at = model.joints[joint].idx_q
                wanted = pin.XYZQUATToSE3(np.array([*value[:3], *value[4:], value[3]]))
                q[at : at + 7] = pin.SE3ToXYZQUAT(model.jointPlacements[joint].actInv(wanted))
        return q

    def placed(poses):
        for pose in poses:
            pin.forwardKinematics(model, data, standing(pose))
            pin.updateFramePlacements(model, data)
            ats = {frame.name: data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)] for frame in frames}
            yield {name: (at.translation, at.rotation) for name, at in ats.items()}

    def moved(asked, steps):
        damping = np.diag(model.damping)

        def dynamics(q, v):
            mass = pin.crba(model, data, q)
            return np.triu(mass) + np.triu(mass, 1).T, -pin.nonLinearEffects(model, data, q, v) - damping @ v

        def advanced(q, way):
            return pin.integrate(model, q, way)

        start = standing(asked["home"])
        end = fallen(start, steps, model.nv, lambda q, v: damping, dynamics=dynamics, moved=advanced)
        single = ((names[at], model.joints[at]) for at in range(1, model.njoints) if model.joints[at].nv == 1)
        ats = {name: end[joint.idx_q : joint.idx_q + joint.nq] for name, joint in single}
        return {name: at[0] if len(at) == 1 else np.arctan2(at[1], at[0]) for name, at in ats.items()}

    def driven(asked, steps):
        of = {name: model.joints[names.index(name)] for name in found["commands"] if name in names}

        def forces(q, v, which):
            """Return the forces of all servos and motors, and their damping."""
            tau = np.zeros(model.nv)
            damping = np.zeros(model.nv)
            for drive in asked["drives"].values():
                if (name := drive["joint"]) in of:
                    at = of[name].idx_q
                    dof = of[name].idx_v
                    angle = q[at] if of[name].nq == 1 else np.arctan2(q[at + 1], q[at])
                    most = found["joints"][name]["force"]
                    tau[dof], damping[dof] = torque(drive, which, found["commands"][name], angle, v[dof], most)
            return tau, damping

        def dynamics(q, v):
            mass = pin.crba(model, data, q)
            force = forces(q, v, "eased")[0] - pin.nonLinearEffects(model, data, q, v) - model.damping * v
            return np.triu(mass) + np.triu(mass, 1).T, force

        def resisting(q, v):
            return np.diag(model.damping + forces(q, v, "eased")[1])

        def advanced(q, way):
            return pin.integrate(model, q, way)

        start = standing(asked["home"])
        first, _ = forces(start, np.zeros(model.nv), "full")
        end = fallen(start, steps, model.nv, resisting, dynamics=dynamics, moved=advanced)
        single = {names[at]: model.joints[at] for at in range(1, model.njoints) if model.joints[at].nv == 1}
        ats = {name: end[joint.idx_q : joint.idx_q + joint.nq] for name, joint in single.items()}
        ends_of = {name: at[0] if len(at) == 1 else np.arctan2(at[1], at[0]) for name, at in ats.items()}
        return {name: first[joint.idx_v] for name, joint in single.items()}, ends_of

    return found, placed, moved, driven if urdf else None
