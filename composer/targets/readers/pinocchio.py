"""Facts of a model as Pinocchio reads it: `python pinocchio.py MODEL POSES.json FACTS.json`."""

import json
import sys

import numpy as np
import pinocchio as pin

file = sys.argv[1]
model = (pin.buildModelFromUrdf if file.endswith(".urdf") else pin.buildModelFromMJCF)(file)
data = model.createData()

found = {
    "version": pin.__version__,
    "composite": True,
    "bodies": {},
    "joints": {},
    "actuators": {},
    "poses": [],
}
frames = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
for frame in frames:
    if frame.parentJoint:  # what is fixed to a body is part of it
        inertia = frame.placement.actInv(model.inertias[frame.parentJoint])
        found["bodies"][frame.name] = {
            "mass": inertia.mass,
            "com": inertia.lever.tolist(),
            "inertia": inertia.inertia.tolist(),
        }
names = list(model.names)
for number in range(1, model.njoints):
    joint = model.joints[number]
    if joint.nq == 2 and joint.nv == 1:  # a joint without limits: cosine and sine
        found["joints"][names[number]] = {"range": None}
    if joint.nq == 1:
        low, high = float(model.lowerPositionLimit[joint.idx_q]), float(model.upperPositionLimit[joint.idx_q])
        bounded = np.isfinite([low, high]).all() and abs(low) < 1e30
        found["joints"][names[number]] = {"range": [low, high] if bounded else None}
for pose in json.load(open(sys.argv[2])):
    q = pin.neutral(model)
    for name, value in pose["joints"].items():
        if name in names:
            joint = model.joints[names.index(name)]
            q[joint.idx_q : joint.idx_q + joint.nq] = (
                value if joint.nq == 1 else [np.cos(value[0]), np.sin(value[0])]
            )
    for body, value in pose["free"].items():
        joint = next((f.parentJoint for f in frames if f.name == body), 0)
        if joint and model.joints[joint].nq == 7:
            at = model.joints[joint].idx_q
            wanted = pin.XYZQUATToSE3(np.array([*value[:3], *value[4:], value[3]]))
            q[at : at + 7] = pin.SE3ToXYZQUAT(model.jointPlacements[joint].actInv(wanted))
    pin.forwardKinematics(model, data, q)
    pin.updateFramePlacements(model, data)
    row = {}
    for frame in frames:
        at = data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)]
        row[frame.name] = [at.translation.tolist(), at.rotation.tolist()]
    found["poses"].append(row)
with open(sys.argv[3], "w") as file:
    json.dump(found, file)
