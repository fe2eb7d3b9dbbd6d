"""Facts of a model as Genesis reads it."""

from importlib.metadata import version
from xml.etree import ElementTree

import genesis as gs
import numpy as np
from facts import STEP, ends, facts, inertia, rotation


def numbers(tensor):
    return tensor.cpu().numpy()


def read(file):
    gs.init(backend=gs.cpu, precision="64", logging_level="error")
    tree = ElementTree.parse(file)  # nosec B314  # mjcompose wrote the model, without a document type
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
    entity = scene.add_entity(gs.morphs.MJCF(file=file, align=False, default_armature=None))
    scene.build()

    found = facts(version("genesis-world"), without=["friction"] if constrained else [])
    links = {link.name: link for link in entity.links if link.name != "world"}
    for name, link in links.items():
        about = link.desc
        axes = rotation(link.desc.inertial_quat)
        matrix = axes @ np.asarray(about.inertia, dtype=float) @ axes.T
        found["bodies"][name] = inertia(about.mass, about.inertial_pos, matrix)
    joints = {joint.name: joint for joint in entity.joints if joint.n_qs == 1}
    low, high = (numbers(each).reshape(-1) for each in entity.get_dofs_limit())
    for name, joint in joints.items():
        dof = joint.dofs_idx_local[0]
        found["joints"][name] = {"range": ends(low[dof], high[dof])}
    for word in ("damping", "armature", "stiffness", "frictionloss"):
        values = numbers(getattr(entity, f"get_dofs_{word}")())
        for joint in entity.joints:
            if joint.n_dofs in (1, 3):
                value = float(values[joint.dofs_idx_local[0]])
                found["joints"].setdefault(joint.name, {})[word.removesuffix("loss")] = value
    found["shapes"] = {"all": len(entity.vgeoms)}  # of which kind each is, it does not say
    # Its actuators have no names: they are gains of joints.
    forces = map(numbers, entity.get_dofs_force_range())
    bias = list(map(numbers, entity.get_dofs_act_bias()))
    most_of = np.max(np.abs(list(forces)), axis=0)
    drives = [(each.get("name"), each.get("joint")) for each in tree.iterfind("actuator/*")]
    for name, joint in drives:
        if joint in joints and [each for _, each in drives].count(joint) == 1:
            dof = joints[joint].dofs_idx_local[0]
            found["joints"][joint]["force"] = float(most_of[dof]) if np.isfinite(most_of[dof]) else None
            found["actuators"][name] = {"joint": joint, "kp": -float(bias[1][dof]), "kd": -float(bias[2][dof])}
    start = numbers(entity.get_qpos()).reshape(-1)
    free = {joint.link.name: joint for joint in entity.joints if joint.type == gs.JOINT_TYPE.FREE}

    def standing(pose):
        q = start.copy()
        for known, values in ((joints, pose["joints"]), (free, pose["free"])):
            for name, value in values.items():
                if name in known:
                    q[known[name].qs_idx_local] = value
        return q

    def placed(poses):
        for pose in poses:
            entity.set_qpos(standing(pose))
            at = numbers(entity.get_links_pos()).reshape(-1, 3)
            quats = numbers(entity.get_links_quat()).reshape(-1, 4)
            yield {name: (at[link.idx_local], rotation(quats[link.idx_local])) for name, link in links.items()}

    def moved(asked, steps):
        entity.set_qpos(standing(asked["home"]))
        entity.zero_all_dofs_velocity()
        for _ in range(steps):
            scene.step()
        end = numbers(entity.get_qpos()).reshape(-1)
        return {name: end[joint.qs_idx_local[0]] for name, joint in joints.items()}

    return found, placed, moved
