"""Facts of a model as Newton reads it: `python newton.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version

import mujoco
import newton
import numpy as np
import warp as wp

STEP = 0.0005
SHAPES = {"PLANE": "plane", "HFIELD": "hfield", "SPHERE": "sphere", "CAPSULE": "capsule", "ELLIPSOID": "ellipsoid",
          "CYLINDER": "cylinder", "BOX": "box", "MESH": "mesh", "CONVEX_MESH": "mesh"}  # fmt: skip
builder = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
builder.add_mjcf(sys.argv[1])
model = builder.finalize(device="cpu")


def own_names():
    """Newton names a body by its way from the root, where a name may have slashes itself."""
    parents, children = model.joint_parent.numpy(), model.joint_child.numpy()
    names, joints = {}, {}
    for joint, (parent, child) in enumerate(zip(parents.tolist(), children.tolist())):
        if child in names:  # a second joint closes a loop
            continue
        label = str(model.body_label[child])
        above = f"{model.body_label[parent]}/" if parent >= 0 else label.partition("worldbody/")[0] + "worldbody/"
        names[child] = label.removeprefix(above)
        joints[joint] = str(model.joint_label[joint]).removeprefix(f"{label}/").removeprefix(above)
    return names, joints


names, joints = own_names()
numbers = {name: number for number, name in joints.items()}
mass, com, inertia = (each.numpy() for each in (model.body_mass, model.body_com, model.body_inertia))
types, starts, dofs = (each.numpy() for each in (model.joint_type, model.joint_q_start, model.joint_qd_start))
low, high = model.joint_limit_lower.numpy(), model.joint_limit_upper.numpy()
of_body = {names[int(model.joint_child.numpy()[number])]: number for number in joints}

found = {"version": version("newton"), "bodies": {}, "joints": {}, "actuators": {}, "poses": [], "shapes": {}}
for number, name in names.items():
    found["bodies"][name] = {
        "mass": float(mass[number]), "com": com[number].tolist(), "inertia": inertia[number].tolist(),
    }  # fmt: skip
single = (int(newton.JointType.REVOLUTE), int(newton.JointType.PRISMATIC))
for number, name in joints.items():
    if types[number] in single:
        ends = float(low[dofs[number]]), float(high[dofs[number]])
        found["joints"][name] = {"range": list(ends) if max(map(abs, ends)) < 1e9 else None}
        most = float(model.joint_effort_limit.numpy()[dofs[number]])
        found["joints"][name]["force"] = most if most < 1e6 else None
    if types[number] in (*single, int(newton.JointType.BALL)):
        found["joints"].setdefault(name, {})
        for word in ("damping", "friction", "armature", "stiffness"):
            found["joints"][name][word] = float(getattr(model, f"joint_{word}").numpy()[dofs[number]])
sites = model.shape_flags.numpy() & int(newton.ShapeFlags.SITE) != 0
for kind in model.shape_type.numpy()[~sites].tolist():
    word = SHAPES[newton.GeoType(kind).name]
    found["shapes"][word] = found["shapes"].get(word, 0) + 1
# Servos are gains of joints.
gains = [getattr(model, f"joint_target_{name}").numpy() for name in ("ke", "kd")]
labels = getattr(model.mujoco, "actuator_label", ())
driven = [int(each[0]) for each in model.mujoco.actuator_trnid.numpy()] if labels else []
for label, dof, kind in zip(labels, driven, model.mujoco.actuator_trntype.numpy() if labels else ()):
    of = (name for number, name in joints.items() if types[number] in single and dofs[number] == dof)
    joint = next(of, None) if kind == 0 else None
    found["actuators"][str(label)] = {"joint": joint}
    if joint is not None and driven.count(dof) == 1:
        found["actuators"][str(label)] |= {"kp": float(gains[0][dof]), "kd": float(gains[1][dof])}
start = model.joint_q.numpy()
asked = json.load(open(sys.argv[2]))


def standing(pose):
    q = start.copy()
    for name, value in pose["joints"].items():
        if name in numbers:
            q[starts[numbers[name]]] = value[0]
    for name, value in pose["free"].items():
        at = starts[of_body[name]]
        q[at : at + 7] = [*value[:3], *value[4:], value[3]]
    return q


for pose in asked["poses"]:
    q = standing(pose)
    state = model.state()
    newton.eval_fk(model, wp.array(q, dtype=float, device="cpu"), model.joint_qd, state)
    row = {}
    for number, name in names.items():
        at = state.body_q.numpy()[number]
        turned = np.array(wp.quat_to_matrix(wp.quat(*map(float, at[3:])))).reshape(3, 3)
        row[name] = [at[:3].tolist(), turned.tolist()]
    found["poses"].append(row)
if asked["seconds"]:
    model.set_gravity(asked["gravity"])
    model.joint_q.assign(standing(asked["home"]))
    solver = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, disable_contacts=True)
    for flag in ("CONTACT", "LIMIT", "EQUALITY", "ACTUATION"):
        solver.mj_model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    before, after, control = model.state(), model.state(), model.control()
    newton.eval_fk(model, model.joint_q, model.joint_qd, before)
    for _ in range(round(asked["seconds"] / STEP)):
        solver.step(before, after, control, None, STEP)
        before, after = after, before
    end = before.joint_q.numpy()
    found["motion"] = {name: float(end[starts[number]]) for number, name in joints.items() if types[number] in single}
json.dump(found, open(sys.argv[3], "w"))
