"""Facts of a model as Drake reads it."""

from importlib.metadata import version

import numpy as np
from facts import count, ends, facts, fallen, inertia, torque
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

SHAPES = {"HalfSpace": "plane", "Convex": "mesh"}


def read(file):
    builder = DiagramBuilder()
    plant, scene = AddMultibodyPlantSceneGraph(builder, 0.0)
    (model,) = Parser(plant).AddModels(file)[:1]
    plant.Finalize()
    diagram = builder.Build()
    context = plant.GetMyMutableContextFromRoot(diagram.CreateDefaultContext())
    bodies = {plant.get_body(i).name(): plant.get_body(i) for i in plant.GetBodyIndices(model)}
    joints = {plant.get_joint(i).name(): plant.get_joint(i) for i in plant.GetJointIndices(model)}
    single = {name: joint for name, joint in joints.items() if joint.num_positions() == 1}

    found = facts(version("drake"), without=[])
    for name, body in bodies.items():
        spatial = body.CalcSpatialInertiaInBodyFrame(context)
        about_com = spatial.Shift(spatial.get_com()).CalcRotationalInertia()
        found["bodies"][name] = inertia(spatial.get_mass(), spatial.get_com(), about_com.CopyToFullMatrix3())
    for name, joint in joints.items():
        if name in single:
            found["joints"][name] = {"range": ends(joint.position_lower_limits()[0], joint.position_upper_limits()[0])}
        if joint.num_velocities() in (1, 3):
            damping = float(joint.default_damping_vector()[0])
            found["joints"].setdefault(name, {}).update(damping=damping, armature=0.0)
    for index in plant.GetJointActuatorIndices(model):
        actuator = plant.get_joint_actuator(index)
        effort = actuator.effort_limit()
        joint = actuator.joint().name()
        gains = actuator.get_controller_gains() if actuator.has_controller() else None
        found["actuators"][actuator.name()] = {
            "joint": joint,
            "kp": gains.p if gains else 0.0,
            "kd": gains.d if gains else 0.0,
            "effort": ends(-effort, effort),
        }
        found["joints"][joint]["armature"] = actuator.default_rotor_inertia() * actuator.default_gear_ratio() ** 2
    inspector = scene.model_inspector()
    for body in [plant.world_body(), *bodies.values()]:
        shapes = (*plant.GetVisualGeometriesForBody(body), *plant.GetCollisionGeometriesForBody(body))
        # Colliding shapes are shown, too.
        for geometry in {inspector.GetName(each): each for each in shapes}.values():
            kind = type(inspector.GetShape(geometry)).__name__
            count(found, SHAPES.get(kind, kind.lower()))

    def stand(pose):
        positions = plant.GetPositions(context)
        for name, value in pose["joints"].items():
            if name in single:
                positions[single[name].position_start()] = value[0]
        for name, value in pose["free"].items():
            if name in bodies:
                start = bodies[name].floating_positions_start()
                positions[start : start + 7] = [*value[3:], *value[:3]]
        plant.SetPositions(context, positions)

    def placed(poses):
        for pose in poses:
            stand(pose)
            ats = {name: plant.EvalBodyPoseInWorld(context, body) for name, body in bodies.items()}
            yield {name: (at.translation(), at.rotation().matrix()) for name, at in ats.items()}

    def moved(asked, steps):
        stand(asked["home"])
        damping = np.zeros(plant.num_velocities())
        for joint in joints.values():
            start = joint.velocity_start()
            damping[start : start + joint.num_velocities()] = joint.default_damping_vector()

        def dynamics(q, v):
            plant.SetPositions(context, q)
            plant.SetVelocities(context, v)
            force = plant.CalcGravityGeneralizedForces(context) - plant.CalcBiasTerm(context) - damping * v
            return plant.CalcMassMatrix(context), force

        def advanced(q, way):
            return q + plant.MapVelocityToQDot(context, way)

        start = plant.GetPositions(context)
        matrix = np.diag(damping)
        end = fallen(start, steps, len(damping), lambda q, v: matrix, dynamics=dynamics, moved=advanced)
        return {name: end[joint.position_start()] for name, joint in single.items()}

    def driven(asked, steps):
        stand(asked["home"])
        of_joints = np.zeros(plant.num_velocities())
        for joint in joints.values():
            start = joint.velocity_start()
            of_joints[start : start + joint.num_velocities()] = joint.default_damping_vector()

        def forces(q, v, which):
            """Return the forces of all servos and motors, and their damping."""
            tau = np.zeros(len(of_joints))
            damping = np.zeros(len(of_joints))
            for name, drive in asked["drives"].items():
                if (about := found["actuators"].get(name)) is not None:
                    joint = single[drive["joint"]]
                    at = single[drive["joint"]].velocity_start()
                    most = about["effort"][1] if about["effort"] is not None else None
                    force, resistance = torque(drive, which, about, q[joint.position_start()], v[at], most)
                    tau[at] = tau[at] + force
                    damping[at] = damping[at] + resistance
            return tau, damping

        def dynamics(q, v):
            plant.SetPositions(context, q)
            plant.SetVelocities(context, v)
            force = plant.CalcGravityGeneralizedForces(context) - plant.CalcBiasTerm(context) - of_joints * v
            return plant.CalcMassMatrix(context), force + forces(q, v, "eased")[0]

        def resisting(q, v):
            return np.diag(of_joints + forces(q, v, "eased")[1])

        def advanced(q, way):
            return q + plant.MapVelocityToQDot(context, way)

        start = plant.GetPositions(context)
        first, _ = forces(start, np.zeros(len(of_joints)), "full")
        end = fallen(start, steps, len(of_joints), resisting, dynamics=dynamics, moved=advanced)
        return (
            {name: first[joint.velocity_start()] for name, joint in single.items()},
            {name: end[joint.position_start()] for name, joint in single.items()},
        )

    return found, placed, moved, driven
