"""Facts of a model as Newton reads it."""

from importlib.metadata import version

import mujoco
import newton
import warp as wp
from facts import STEP, count, facts, inertia, rotation, without_forces

SHAPES = {"CONVEX_MESH": "mesh"}
SINGLE = (int(newton.JointType.REVOLUTE), int(newton.JointType.PRISMATIC))


def read(file):
    builder = newton.ModelBuilder()
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    builder.add_mjcf(file)
    model = builder.finalize(device="cpu")
    names, joints = own_names(model)
    numbers = {name: number for number, name in joints.items()}
    types, starts, dofs = (each.numpy() for each in (model.joint_type, model.joint_q_start, model.joint_qd_start))
    low = model.joint_limit_lower.numpy()
    high = model.joint_limit_upper.numpy()
    of_body = {names[int(model.joint_child.numpy()[number])]: number for number in joints}

    found = facts(version("newton"))
    mass, com, matrix = (each.numpy() for each in (model.body_mass, model.body_com, model.body_inertia))
    for number, name in names.items():
        found["bodies"][name] = inertia(mass[number], com[number], matrix[number])
    for number, name in joints.items():
        about = found["joints"].setdefault(name, {}) if types[number] in (*SINGLE, int(newton.JointType.BALL)) else {}
        if types[number] in SINGLE:
            bounds = [float(low[dofs[number]]), float(high[dofs[number]])]
            most = float(model.joint_effort_limit.numpy()[dofs[number]])
            about |= {"range": bounds if max(map(abs, bounds)) < 1e9 else None, "force": most if most < 1e6 else None}
        for word in ("damping", "friction", "armature", "stiffness"):
            about[word] = float(getattr(model, f"joint_{word}").numpy()[dofs[number]])
    sites = model.shape_flags.numpy() & int(newton.ShapeFlags.SITE) != 0
    for kind in model.shape_type.numpy()[~sites].tolist():
        word = newton.GeoType(kind).name
        count(found, SHAPES.get(word, word.lower()))
    # Servos are gains of joints.
    gains = [getattr(model, f"joint_target_{name}").numpy() for name in ("ke", "kd")]
    labels = getattr(model.mujoco, "actuator_label", ())
    driven = [int(each[0]) for each in model.mujoco.actuator_trnid.numpy()] if labels else []
    for label, dof, kind in zip(labels, driven, model.mujoco.actuator_trntype.numpy() if labels else ()):
        of = (name for number, name in joints.items() if types[number] in SINGLE and dofs[number] == dof)
        joint = next(of, None) if kind == 0 else None
        found["actuators"][str(label)] = {"joint": joint}
        if joint is not None and driven.count(dof) == 1:
            found["actuators"][str(label)] |= {"kp": float(gains[0][dof]), "kd": float(gains[1][dof])}
    start = model.joint_q.numpy()

    def standing(pose):
        q = start.copy()
        for name, value in pose["joints"].items():
            if name in numbers:
                q[starts[numbers[name]]] = value[0]
        for name, value in pose["free"].items():
            at = starts[of_body[name]]
            q[at : at + 7] = [*value[:3], *value[4:], value[3]]
        return q

    def placed(poses):
        for pose in poses:
            state = model.state()
            newton.eval_fk(model, wp.array(standing(pose), dtype=float, device="cpu"), model.joint_qd, state)
            ats = state.body_q.numpy()
            yield {name: (ats[at][:3], rotation([ats[at][6], *ats[at][3:6]])) for at, name in names.items()}

    def moved(asked, steps):
        model.set_gravity(asked["gravity"])
        model.joint_q.assign(standing(asked["home"]))
        solver = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True, disable_contacts=True)
        without_forces(mujoco, solver.mj_model)
        before = model.state()
        after = model.state()
        control = model.control()
        newton.eval_fk(model, model.joint_q, model.joint_qd, before)
        for _ in range(steps):
            solver.step(before, after, control, None, STEP)
            before, after = after, before
        end = before.joint_q.numpy()
        return {name: end[starts[number]] for number, name in joints.items() if types[number] in SINGLE}

    return found, placed, moved


def own_names(model):
    """Newton names a body by its path from the root, in which names may contain slashes themselves."""
    parents = model.joint_parent.numpy()
    children = model.joint_child.numpy()
    names = {}
    joints = {}
    for joint, (parent, child) in enumerate(zip(parents.tolist(), children.tolist())):
        if child in names:  # a second joint closes a loop
            continue
        label = str(model.body_label[child])
        above = f"{model.body_label[parent]}/" if parent >= 0 else label.partition("worldbody/")[0] + "worldbody/"
        names[child] = label.removeprefix(above)
        joints[joint] = str(model.joint_label[joint]).removeprefix(f"{label}/").removeprefix(above)
    return names, joints
