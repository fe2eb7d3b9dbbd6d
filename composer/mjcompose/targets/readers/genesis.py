"""Facts of a model as Genesis reads it: `python genesis.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version
from xml.etree import ElementTree

import genesis as gs
import numpy as np

gs.init(backend=gs.cpu, precision="64", logging_level="error")
STEP = 0.0005
tree = ElementTree.parse(sys.argv[1])  # nosec B314  # mjcompose wrote the model, without a document type
# Constraints cannot be switched off without dry friction.
constrained = tree.find("equality") is not None
scene = gs.Scene(
    show_viewer=False,
    sim_options=gs.options.SimOptions(dt=STEP),
    rigid_options=gs.options.RigidOptions(
        enable_collision=False, enable_joint_limit=False, disable_constraint=constrained
    ),
)
# Not aligned: the origin of a free body stays where the model has it. And no armature where the model has none.
entity = scene.add_entity(gs.morphs.MJCF(file=sys.argv[1], align=False, default_armature=None))
scene.build()


def turned(quat):
    w, x, y, z = np.asarray(quat, dtype=float)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


found = {
    "version": version("genesis-world"), "bodies": {}, "joints": {}, "actuators": {}, "poses": [], "shapes": {},
}  # fmt: skip
links = {link.name: link for link in entity.links if link.name != "world"}
for name, link in links.items():
    axes = turned(link.desc.inertial_quat)
    found["bodies"][name] = {
        "mass": float(link.desc.mass),
        "com": np.asarray(link.desc.inertial_pos, dtype=float).tolist(),
        "inertia": (axes @ np.asarray(link.desc.inertia, dtype=float) @ axes.T).tolist(),
    }
joints = {joint.name: joint for joint in entity.joints if joint.n_qs == 1}
low, high = (each.cpu().numpy().reshape(-1) for each in entity.get_dofs_limit())
for name, joint in joints.items():
    ends = [float(each[joint.dofs_idx_local[0]]) for each in (low, high)]
    found["joints"][name] = {"range": ends if np.isfinite(ends).all() else None}
arrays = {
    word: getattr(entity, f"get_dofs_{word}")().cpu().numpy()
    for word in ("damping", "armature", "stiffness", "frictionloss")
}
for joint in entity.joints:
    if joint.n_dofs in (1, 3):
        for word, values in arrays.items():
            word = word.removesuffix("loss")
            found["joints"].setdefault(joint.name, {})[word] = float(values[joint.dofs_idx_local[0]])
found["shapes"] = {"all": len(entity.vgeoms)}  # of which kind each is, it does not say
# Its actuators have no names: they are gains of joints.
forces = [each.cpu().numpy() for each in entity.get_dofs_force_range()]
bias = [each.cpu().numpy() for each in entity.get_dofs_act_bias()]
drives = [(each.get("name"), each.get("joint")) for each in tree.iterfind("actuator/*")]
for name, joint in drives:
    if joint in joints and [each for _, each in drives].count(joint) == 1:
        dof = joints[joint].dofs_idx_local[0]
        most = max(abs(float(each[dof])) for each in forces)
        found["joints"][joint]["force"] = most if np.isfinite(most) else None
        found["actuators"][name] = {"joint": joint, "kp": -float(bias[1][dof]), "kd": -float(bias[2][dof])}
start = entity.get_qpos().cpu().numpy().reshape(-1)
free = {joint.link.name: joint for joint in entity.joints if joint.type == gs.JOINT_TYPE.FREE}
asked = json.load(open(sys.argv[2]))


def standing(pose):
    q = start.copy()
    for name, value in pose["joints"].items():
        if name in joints:
            q[joints[name].qs_idx_local] = value
    for name, value in pose["free"].items():
        if name in free:
            q[free[name].qs_idx_local] = value
    return q


for pose in asked["poses"]:
    entity.set_qpos(standing(pose))
    at = entity.get_links_pos().cpu().numpy().reshape(-1, 3)
    quats = entity.get_links_quat().cpu().numpy().reshape(-1, 4)
    row = {}
    for name, link in links.items():
        row[name] = [at[link.idx_local].tolist(), turned(quats[link.idx_local]).tolist()]
    found["poses"].append(row)
if asked["seconds"]:
    entity.set_qpos(standing(asked["home"]))
    entity.zero_all_dofs_velocity()
    for _ in range(round(asked["seconds"] / STEP)):
        scene.step()
    end = entity.get_qpos().cpu().numpy().reshape(-1)
    found["without"] = ["friction"] if constrained else []
    found["motion"] = {name: float(end[joint.qs_idx_local[0]]) for name, joint in joints.items()}
json.dump(found, open(sys.argv[3], "w"))
