"""Facts of a model as Newton reads it: `python newton.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version

import newton
import numpy as np
import warp as wp

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
        above = (
            f"{model.body_label[parent]}/" if parent >= 0 else label.partition("worldbody/")[0] + "worldbody/"
        )
        names[child] = label.removeprefix(above)
        joints[joint] = str(model.joint_label[joint]).removeprefix(f"{label}/").removeprefix(above)
    return names, joints


names, joints = own_names()
numbers = {name: number for number, name in joints.items()}
mass, com, inertia = (each.numpy() for each in (model.body_mass, model.body_com, model.body_inertia))
types, starts, dofs = (each.numpy() for each in (model.joint_type, model.joint_q_start, model.joint_qd_start))
low, high = model.joint_limit_lower.numpy(), model.joint_limit_upper.numpy()
of_body = {names[int(model.joint_child.numpy()[number])]: number for number in joints}

found = {"version": version("newton"), "bodies": {}, "joints": {}, "actuators": {}, "poses": []}
for number, name in names.items():
    found["bodies"][name] = {
        "mass": float(mass[number]),
        "com": com[number].tolist(),
        "inertia": inertia[number].tolist(),
    }
single = (int(newton.JointType.REVOLUTE), int(newton.JointType.PRISMATIC))
for number, name in joints.items():
    if types[number] in single:
        ends = float(low[dofs[number]]), float(high[dofs[number]])
        found["joints"][name] = {"range": list(ends) if max(map(abs, ends)) < 1e9 else None}
start = model.joint_q.numpy()
for pose in json.load(open(sys.argv[2])):
    q = start.copy()
    for name, value in pose["joints"].items():
        if name in numbers:
            q[starts[numbers[name]]] = value[0]
    for name, value in pose["free"].items():
        at = starts[of_body[name]]
        q[at : at + 7] = [*value[:3], *value[4:], value[3]]
    state = model.state()
    newton.eval_fk(model, wp.array(q, dtype=float, device="cpu"), model.joint_qd, state)
    row = {}
    for number, name in names.items():
        at = state.body_q.numpy()[number]
        turned = np.array(wp.quat_to_matrix(wp.quat(*map(float, at[3:])))).reshape(3, 3)
        row[name] = [at[:3].tolist(), turned.tolist()]
    found["poses"].append(row)
with open(sys.argv[3], "w") as file:
    json.dump(found, file)
