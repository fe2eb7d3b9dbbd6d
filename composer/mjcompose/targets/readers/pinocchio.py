"""Facts of a model as Pinocchio reads it: `python pinocchio.py MODEL POSES.json FACTS.json`."""

import json
import sys

import numpy as np
import pinocchio as pin

file = sys.argv[1]
model = (pin.buildModelFromUrdf if file.endswith(".urdf") else pin.buildModelFromMJCF)(file)
data = model.createData()

STEP = 0.0005
SHAPES = {
    "Halfspace": "plane", "Plane": "plane", "Sphere": "sphere", "Capsule": "capsule", "Ellipsoid": "ellipsoid",
    "Cylinder": "cylinder", "Box": "box", "BVHModelOBBRSS": "mesh", "Convex": "mesh", "ConvexBase": "mesh",
}  # fmt: skip


def dynamics(joint, limited=True):
    at = joint.idx_v
    found = {"damping": float(model.damping[at]), "friction": float(model.upperDryFrictionLimit[at])}
    if not urdf:
        found["armature"] = float(model.armature[at])
    if limited:
        most = float(model.upperEffortLimit[at])
        unlimited = not np.isfinite(most) or (urdf and most == 1e6)
        found["force"] = None if unlimited else most
    return found


found = {
    "version": pin.__version__, "composite": True, "shapes": {}, "bodies": {}, "joints": {}, "actuators": {},
    "poses": [],
}  # fmt: skip
frames = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
for frame in frames:
    if frame.parentJoint:  # frames that are fixed to a body are part of it
        inertia = frame.placement.actInv(model.inertias[frame.parentJoint])
        found["bodies"][frame.name] = {
            "mass": inertia.mass, "com": inertia.lever.tolist(), "inertia": inertia.inertia.tolist(),
        }  # fmt: skip
names = list(model.names)
urdf = file.endswith(".urdf")
for number in range(1, model.njoints):
    joint = model.joints[number]
    if joint.nq == 2 and joint.nv == 1:  # a joint without limits: cosine and sine
        found["joints"][names[number]] = {"range": None, **dynamics(joint)}
    if joint.nq == 1:
        low, high = float(model.lowerPositionLimit[joint.idx_q]), float(model.upperPositionLimit[joint.idx_q])
        bounded = np.isfinite([low, high]).all() and abs(low) < 1e30
        found["joints"][names[number]] = {"range": [low, high] if bounded else None, **dynamics(joint)}
    if joint.shortname() in ("JointModelSpherical", "JointModelSphericalZYX"):
        found["joints"][names[number]] = dynamics(joint, limited=False)
if not urdf:
    seen = set()
    for kind in (pin.GeometryType.COLLISION, pin.GeometryType.VISUAL):
        for shape in pin.buildGeomFromMJCF(model, file, kind).geometryObjects:
            if shape.name not in seen:
                seen.add(shape.name)
                word = SHAPES[type(shape.geometry).__name__]
                found["shapes"][word] = found["shapes"].get(word, 0) + 1
else:
    del found["shapes"]
asked = json.load(open(sys.argv[2]))


def standing(pose):
    q = pin.neutral(model)
    for name, value in pose["joints"].items():
        if name in names:
            joint = model.joints[names.index(name)]
            q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else [np.cos(value[0]), np.sin(value[0])]
    for body, value in pose["free"].items():
        joint = next((f.parentJoint for f in frames if f.name == body), 0)
        if joint and model.joints[joint].nq == 7:
            at = model.joints[joint].idx_q
            wanted = pin.XYZQUATToSE3(np.array([*value[:3], *value[4:], value[3]]))
            q[at : at + 7] = pin.SE3ToXYZQUAT(model.jointPlacements[joint].actInv(wanted))
    return q


for pose in asked["poses"]:
    pin.forwardKinematics(model, data, standing(pose))
    pin.updateFramePlacements(model, data)
    row = {}
    for frame in frames:
        at = data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)]
        row[frame.name] = [at.translation.tolist(), at.rotation.tolist()]
    found["poses"].append(row)
if asked["seconds"]:
    found["motion"], found["without"] = {}, ["friction"]
    q, v, damping = standing(asked["home"]), np.zeros(model.nv), np.diag(model.damping)
    for _ in range(round(asked["seconds"] / STEP)):
        mass = pin.crba(model, data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        force = -pin.nonLinearEffects(model, data, q, v) - damping @ v
        v = v + STEP * np.linalg.solve(mass + STEP * damping, force)
        q = pin.integrate(model, q, STEP * v)
    for number in range(1, model.njoints):
        joint = model.joints[number]
        if joint.nv == 1:
            at = q[joint.idx_q : joint.idx_q + joint.nq]
            found["motion"][names[number]] = float(at[0] if joint.nq == 1 else np.arctan2(at[1], at[0]))
json.dump(found, open(sys.argv[3], "w"))
