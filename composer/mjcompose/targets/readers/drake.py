"""Facts of a model as Drake reads it."""

from importlib.metadata import version

import numpy as np
from facts import count, ends, facts, fallen, inertia, no_forces, torque
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

SHAPES = {"HalfSpace": "plane", "Convex": "mesh"}


def read(file):
    robot = DrakeRobot(file)
    return robot.facts(), robot.placed, robot.moved, robot.driven


class DrakeRobot:
    """A model in a plant of Drake; `single` are the joints with one position."""

    def __init__(self, file):
        builder = DiagramBuilder()
        plant, self.scene = AddMultibodyPlantSceneGraph(builder, 0.0)
        (model,) = Parser(plant).AddModels(file)[:1]
        plant.Finalize()
        self.plant = plant
        self.diagram = builder.Build()
        self.context = plant.GetMyMutableContextFromRoot(self.diagram.CreateDefaultContext())
        bodies = map(plant.get_body, plant.GetBodyIndices(model))
        joints = map(plant.get_joint, plant.GetJointIndices(model))
        actuators = map(plant.get_joint_actuator, plant.GetJointActuatorIndices(model))
        self.bodies = {body.name(): body for body in bodies}
        self.joints = {joint.name(): joint for joint in joints}
        self.single = {name: joint for name, joint in self.joints.items() if joint.num_positions() == 1}
        self.actuators = {actuator.name(): actuator for actuator in actuators}
        self.damping = np.zeros(plant.num_velocities())
        for joint in self.joints.values():
            start = joint.velocity_start()
            self.damping[start : start + joint.num_velocities()] = joint.default_damping_vector()

    def facts(self):
        found = facts(version("drake"), without=[])
        found["bodies"] = {name: self.body_facts(body) for name, body in self.bodies.items()}
        found["joints"] = self.joint_facts()
        found["actuators"] = self.actuator_facts()
        for actuator in self.actuators.values():
            armature = actuator.default_rotor_inertia() * actuator.default_gear_ratio() ** 2
            found["joints"][actuator.joint().name()]["armature"] = armature
        self.count_shapes(found)
        return found

    def body_facts(self, body):
        spatial = body.CalcSpatialInertiaInBodyFrame(self.context)
        about_com = spatial.Shift(spatial.get_com()).CalcRotationalInertia()
        return inertia(spatial.get_mass(), spatial.get_com(), about_com.CopyToFullMatrix3())

    def joint_facts(self):
        found = {}
        for name, joint in self.joints.items():
            if name in self.single:
                found[name] = {"range": ends(joint.position_lower_limits()[0], joint.position_upper_limits()[0])}
            if joint.num_velocities() in (1, 3):
                damping = float(joint.default_damping_vector()[0])
                found.setdefault(name, {}).update(damping=damping, armature=0.0)
        return found

    def actuator_facts(self):
        found = {}
        for name, actuator in self.actuators.items():
            effort = actuator.effort_limit()
            gains = actuator.get_controller_gains() if actuator.has_controller() else None
            found[name] = {
                "joint": actuator.joint().name(),
                "kp": gains.p if gains else 0.0,
                "kd": gains.d if gains else 0.0,
                "effort": ends(-effort, effort),
            }
        return found

    def count_shapes(self, found):
        plant = self.plant
        inspector = self.scene.model_inspector()
        for body in [plant.world_body(), *self.bodies.values()]:
            shapes = (*plant.GetVisualGeometriesForBody(body), *plant.GetCollisionGeometriesForBody(body))
            # Colliding shapes are shown, too.
            for geometry in {inspector.GetName(shape): shape for shape in shapes}.values():
                kind = type(inspector.GetShape(geometry)).__name__
                count(found, SHAPES.get(kind, kind.lower()))

    def stand(self, pose):
        positions = self.plant.GetPositions(self.context)
        for name, value in pose["joints"].items():
            if name in self.single:
                positions[self.single[name].position_start()] = value[0]
        for name, value in pose["free"].items():
            if name in self.bodies:
                start = self.bodies[name].floating_positions_start()
                positions[start : start + 7] = [*value[3:], *value[:3]]
        self.plant.SetPositions(self.context, positions)

    def placed(self, poses):
        for pose in poses:
            self.stand(pose)
            ats = {name: self.plant.EvalBodyPoseInWorld(self.context, body) for name, body in self.bodies.items()}
            yield {name: (at.translation(), at.rotation().matrix()) for name, at in ats.items()}

    def moved(self, asked, steps):
        self.stand(asked["home"])
        start = self.plant.GetPositions(self.context)
        return self.positions(
            fallen(start, steps, self.damping, no_forces, dynamics=self.dynamics, moved=self.advanced)
        )

    def driven(self, asked, steps):
        self.stand(asked["home"])
        start = self.plant.GetPositions(self.context)
        about = self.actuator_facts()
        drives = {name: drive for name, drive in asked["drives"].items() if name in about}

        def eased(q, v):
            return self.forces(drives, about, q, v, "eased")

        first, _ = self.forces(drives, about, start, np.zeros(len(self.damping)), "full")
        end = fallen(start, steps, self.damping, eased, dynamics=self.dynamics, moved=self.advanced)
        return {name: first[joint.velocity_start()] for name, joint in self.single.items()}, self.positions(end)

    def forces(self, drives, about, q, v, which):
        """Return the forces of all servos and motors, and their damping; `about` has the facts of actuators."""
        forces = np.zeros(len(self.damping))
        damping = np.zeros(len(self.damping))
        for name, drive in drives.items():
            joint = self.single[drive["joint"]]
            at = joint.velocity_start()
            effort = about[name]["effort"]
            most = effort[1] if effort is not None else None
            force, resistance = torque(drive, which, about[name], q[joint.position_start()], v[at], most)
            forces[at] += force
            damping[at] += resistance
        return forces, damping

    def dynamics(self, q, v, driving):
        plant = self.plant
        context = self.context
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        force = plant.CalcGravityGeneralizedForces(context) - plant.CalcBiasTerm(context) - self.damping * v
        return plant.CalcMassMatrix(context), force + driving

    def advanced(self, q, way):
        return q + self.plant.MapVelocityToQDot(self.context, way)

    def positions(self, q):
        return {name: q[joint.position_start()] for name, joint in self.single.items()}
