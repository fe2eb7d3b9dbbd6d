"""Facts of a model as Genesis reads it."""

from collections import Counter
from importlib.metadata import version
from xml.etree import ElementTree

import genesis as gs
import numpy as np
from facts import STEP, ends, facts, inertia, rotation


def numbers(tensor):
    return tensor.cpu().numpy()


def read(file):
    robot = GenesisRobot(file)
    return robot.facts(), robot.placed, robot.moved


class GenesisRobot:
    """A model of Genesis; `links` and the `joints` with one degree of freedom are by name."""

    def __init__(self, file):
        gs.init(backend=gs.cpu, precision="64", logging_level="error")
        self.tree = ElementTree.parse(file)  # nosec B314  # mjcompose wrote the model, without a document type
        # Constraints cannot be switched off without dry friction.
        self.is_constrained = self.tree.find("equality") is not None
        self.scene = gs.Scene(
            show_viewer=False,
            sim_options=gs.options.SimOptions(dt=STEP),
            rigid_options=gs.options.RigidOptions(
                enable_collision=False, enable_joint_limit=False, disable_constraint=self.is_constrained
            ),
        )
        # Not aligned: the origin of a free body stays where the model has it. And no armature where the model has none.
        morph = gs.morphs.MJCF(file=file, align=False, default_armature=None)
        self.entity = self.scene.add_entity(morph)
        self.scene.build()
        self.links = {link.name: link for link in self.entity.links if link.name != "world"}
        self.joints = {joint.name: joint for joint in self.entity.joints if joint.n_qs == 1}
        self.start = numbers(self.entity.get_qpos()).reshape(-1)
        free = (joint for joint in self.entity.joints if joint.type == gs.JOINT_TYPE.FREE)
        self.free = {joint.link.name: joint for joint in free}

    def facts(self):
        model_facts = facts(version("genesis-world"), without=["friction"] if self.is_constrained else [])
        model_facts["bodies"] = {name: self.inertia(link.desc) for name, link in self.links.items()}
        low, high = (numbers(limits).reshape(-1) for limits in self.entity.get_dofs_limit())
        for name, joint in self.joints.items():
            dof = joint.dofs_idx_local[0]
            model_facts["joints"][name] = {"range": ends(low[dof], high[dof])}
        self.add_dynamics(model_facts["joints"])
        model_facts["shapes"] = {"all": len(self.entity.vgeoms)}  # of which kind each is, it does not say
        self.add_drives(model_facts)
        return model_facts

    @staticmethod
    def inertia(about):
        axes = rotation(about.inertial_quat)
        matrix = axes @ np.asarray(about.inertia, dtype=float) @ axes.T
        return inertia(about.mass, about.inertial_pos, matrix)

    def add_dynamics(self, joints):
        for word in ("damping", "armature", "stiffness", "frictionloss"):
            values = numbers(getattr(self.entity, f"get_dofs_{word}")())
            for joint in self.entity.joints:
                if joint.n_dofs in (1, 3):
                    value = float(values[joint.dofs_idx_local[0]])
                    joints.setdefault(joint.name, {})[word.removesuffix("loss")] = value

    def add_drives(self, found):
        """Add the actuators, which have no names in Genesis: they are gains of joints."""
        forces = map(numbers, self.entity.get_dofs_force_range())
        most_of = np.max(np.abs(list(forces)), axis=0)
        bias = list(map(numbers, self.entity.get_dofs_act_bias()))
        drives = [(actuator.get("name"), actuator.get("joint")) for actuator in self.tree.iterfind("actuator/*")]
        uses = Counter(joint for _, joint in drives)
        for name, joint in drives:
            if joint in self.joints and uses[joint] == 1:
                dof = self.joints[joint].dofs_idx_local[0]
                found["joints"][joint]["force"] = float(most_of[dof]) if np.isfinite(most_of[dof]) else None
                found["actuators"][name] = {"joint": joint, "kp": -float(bias[1][dof]), "kd": -float(bias[2][dof])}

    def position(self, pose):
        q = self.start.copy()
        for known, values in ((self.joints, pose["joints"]), (self.free, pose["free"])):
            for name, value in values.items():
                if name in known:
                    q[known[name].qs_idx_local] = value
        return q

    def placed(self, poses):
        for pose in poses:
            self.entity.set_qpos(self.position(pose))
            at = numbers(self.entity.get_links_pos()).reshape(-1, 3)
            quats = numbers(self.entity.get_links_quat()).reshape(-1, 4)
            yield {name: (at[link.idx_local], rotation(quats[link.idx_local])) for name, link in self.links.items()}

    def moved(self, asked, steps):
        self.entity.set_qpos(self.position(asked["home"]))
        self.entity.zero_all_dofs_velocity()
        for _ in range(steps):
            self.scene.step()
        end = numbers(self.entity.get_qpos()).reshape(-1)
        return {name: end[joint.qs_idx_local[0]] for name, joint in self.joints.items()}
