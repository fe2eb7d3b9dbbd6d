"""Facts of a model as Newton reads it."""

from importlib.metadata import version

import mujoco
import newton
import warp as wp
from facts import STEP, count, facts, inertia, rotation, without_forces

SHAPES = {"CONVEX_MESH": "mesh"}
SINGLE = (int(newton.JointType.REVOLUTE), int(newton.JointType.PRISMATIC))


def read(file):
    robot = NewtonRobot(file)
    return robot.facts(), robot.placed, robot.moved


class NewtonRobot:
    """A model of Newton; `names` of bodies and `joints` are by number, `above` has the joint of a body."""

    def __init__(self, file):
        builder = newton.ModelBuilder()
        newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
        builder.add_mjcf(file)
        self.model = builder.finalize(device="cpu")
        self.names, self.joints = own_names(self.model)
        self.numbers = {name: number for number, name in self.joints.items()}
        children = self.model.joint_child.numpy().tolist()
        self.above = {self.names[children[number]]: number for number in self.joints}
        self.types = self.model.joint_type.numpy()
        self.starts = self.model.joint_q_start.numpy()
        self.dofs = self.model.joint_qd_start.numpy()
        self.single = {name: number for number, name in self.joints.items() if self.types[number] in SINGLE}
        self.start = self.model.joint_q.numpy()

    def facts(self):
        found = facts(version("newton"))
        model = self.model
        mass, com, matrix = (array.numpy() for array in (model.body_mass, model.body_com, model.body_inertia))
        for number, name in self.names.items():
            found["bodies"][name] = inertia(mass[number], com[number], matrix[number])
        for number, name in self.joints.items():
            if self.types[number] in SINGLE:
                found["joints"][name] = self.limits(self.dofs[number]) | self.dynamics(self.dofs[number])
            elif self.types[number] == int(newton.JointType.BALL):
                found["joints"][name] = self.dynamics(self.dofs[number])
        self.count_shapes(found)
        found["actuators"] = self.actuators()
        return found

    def limits(self, dof):
        model = self.model
        bounds = [float(model.joint_limit_lower.numpy()[dof]), float(model.joint_limit_upper.numpy()[dof])]
        most = float(model.joint_effort_limit.numpy()[dof])
        return {"range": bounds if max(map(abs, bounds)) < 1e9 else None, "force": most if most < 1e6 else None}

    def dynamics(self, dof):
        words = ("damping", "friction", "armature", "stiffness")
        return {word: float(getattr(self.model, f"joint_{word}").numpy()[dof]) for word in words}

    def count_shapes(self, found):
        sites = self.model.shape_flags.numpy() & int(newton.ShapeFlags.SITE) != 0
        for kind in self.model.shape_type.numpy()[~sites].tolist():
            word = newton.GeoType(kind).name
            count(found, SHAPES.get(word, word.lower()))

    def actuators(self):
        """Return the facts of actuators; servos are gains of joints."""
        found = {}
        own = self.model.mujoco
        labels = getattr(own, "actuator_label", ())
        if not labels:
            return found
        stiffness = self.model.joint_target_ke.numpy()
        damping = self.model.joint_target_kd.numpy()
        joints = {self.dofs[number]: name for name, number in self.single.items()}
        dofs = [int(row[0]) for row in own.actuator_trnid.numpy()]
        for label, dof, kind in zip(labels, dofs, own.actuator_trntype.numpy()):
            joint = joints.get(dof) if kind == 0 else None
            found[str(label)] = {"joint": joint}
            if joint is not None and dofs.count(dof) == 1:
                found[str(label)] |= {"kp": float(stiffness[dof]), "kd": float(damping[dof])}
        return found

    def standing(self, pose):
        q = self.start.copy()
        for name, value in pose["joints"].items():
            if name in self.numbers:
                q[self.starts[self.numbers[name]]] = value[0]
        for name, value in pose["free"].items():
            at = self.starts[self.above[name]]
            q[at : at + 7] = [*value[:3], *value[4:], value[3]]
        return q

    def placed(self, poses):
        model = self.model
        for pose in poses:
            state = model.state()
            newton.eval_fk(model, wp.array(self.standing(pose), dtype=float, device="cpu"), model.joint_qd, state)
            ats = state.body_q.numpy()
            yield {name: (ats[at][:3], rotation([ats[at][6], *ats[at][3:6]])) for at, name in self.names.items()}

    def moved(self, asked, steps):
        model = self.model
        model.set_gravity(asked["gravity"])
        model.joint_q.assign(self.standing(asked["home"]))
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
        return {name: end[self.starts[number]] for name, number in self.single.items()}


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
