"""Three tools, three payloads, two tables: eighteen models, each checked."""

import itertools
import os

import mujoco
import numpy as np

menagerie = os.environ["MENAGERIE_ROOT"]
s = np.sqrt(0.5)
TOOLS = {
    "robotiq": (f"{menagerie}/robotiq_2f85/2f85.xml", [0, 0, 0], [1, 0, 0, 0], {}),
    "simple": ("recipes/models/gripper2/gripper2.xml", [0, 0, 0], [1, 0, 0, 0], {}),
    "hand": (f"{menagerie}/wonik_allegro/left_hand.xml", [0, 0, 0.095], [s, 0, -s, 0], {"tool/thj0": 30}),
}


def made(tool, payload, height):
    spec = mujoco.MjSpec.from_file(f"{menagerie}/universal_robots_ur5e/ur5e.xml")
    spec.modelname = f"tools-{tool}-{payload}kg-{height}m"
    file, pos, quat, pose = TOOLS[tool]
    child = mujoco.MjSpec.from_file(file)
    spec.option.cone, spec.option.impratio = child.option.cone, child.option.impratio
    site = spec.site("attachment_site")
    frame = site.parent.add_frame(pos=site.pos, quat=site.quat)
    inner = site.parent.add_frame(frame, pos=pos, quat=quat)
    spec.attach(child, prefix="tool/", frame=inner)
    table = spec.worldbody.add_body(name="table", pos=[0.7, 0, height - 0.02])
    table.add_geom(name="table", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.3, 0.5, 0.02])
    if payload > 0:
        load = site.parent.add_body(name="payload", pos=[0, 0.1, 0])
        load.add_geom(name="payload", size=[0.03, 0, 0], mass=payload, contype=0, conaffinity=0)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    data.joint("shoulder_pan_joint").qpos = 0
    for joint, angle in pose.items():
        data.joint(joint).qpos = np.deg2rad(angle)
    mujoco.mj_forward(model, data)
    servo = model.actuator_biastype == mujoco.mjtBias.mjBIAS_AFFINE
    gain = np.where(servo, -model.actuator_biasprm[:, 1] / model.actuator_gainprm[:, 0], 0)
    spec.add_key(name="ready", qpos=data.qpos, ctrl=gain * data.actuator_length)
    return spec, spec.compile()


def checked(model):
    key = model.key("ready")
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, key.id)
    mujoco.mj_forward(model, data)
    for contact in data.contact:
        if contact.dist < -1e-3:
            yield f"{model.geom(contact.geom1).name} and {model.geom(contact.geom2).name}: {-contact.dist} m deep"
    joints = (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE) | (model.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE)
    numbers = model.jnt_qposadr[joints]
    limited = joints & (model.jnt_limited == 1)
    for i in np.flatnonzero(limited):
        low, high = model.jnt_range[i]
        if not low <= key.qpos[model.jnt_qposadr[i]] <= high:
            yield f"{model.joint(i).name} is outside of its range"
    for i in np.flatnonzero(model.actuator_ctrllimited):
        low, high = model.actuator_ctrlrange[i]
        if not low <= key.ctrl[i] <= high:
            yield f"{model.actuator(i).name} is outside of its range"
    fastest = 0
    while data.time < 0.5:
        mujoco.mj_step(model, data)
        if data.time > 0.45:
            fastest = max(fastest, np.abs(data.qvel).max())
    if not np.isfinite(data.qpos).all() or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
        yield "the simulation diverges"
    if fastest > 0.05:
        yield f"something moves at {fastest}"
    for i, number in zip(np.flatnonzero(joints), numbers, strict=True):
        if abs(data.qpos[number] - key.qpos[number]) > 0.05:
            yield f"{model.joint(i).name} has moved"


failed = []
for cell in itertools.product(TOOLS, (0, 1, 3), (0.2, 0.4)):
    spec, model = made(*cell)
    faults = list(checked(model))
    failed += [f"{spec.modelname}: {fault}" for fault in faults]
    if not faults:
        mujoco.mj_saveModel(model, f"build/{spec.modelname}.mjb")
if failed:
    raise SystemExit("\n".join(failed))
