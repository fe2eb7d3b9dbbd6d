"""Facts of a model as Drake reads it: `python drake.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

STEP = 0.0005
SHAPES = {"HalfSpace": "plane", "Convex": "mesh"}
builder = DiagramBuilder()
plant, scene = AddMultibodyPlantSceneGraph(builder, 0.0)
(model,) = Parser(plant).AddModels(sys.argv[1])[:1]
plant.Finalize()
diagram = builder.Build()
context = plant.GetMyMutableContextFromRoot(diagram.CreateDefaultContext())
asked = json.load(open(sys.argv[2]))
bodies = {plant.get_body(i).name(): plant.get_body(i) for i in plant.GetBodyIndices(model)}
joints = {plant.get_joint(i).name(): plant.get_joint(i) for i in plant.GetJointIndices(model)}

found = {"version": version("drake"), "bodies": {}, "joints": {}, "actuators": {}, "poses": [], "shapes": {}}
for name, body in bodies.items():
    inertia = body.CalcSpatialInertiaInBodyFrame(context)
    about_com = inertia.Shift(inertia.get_com()).CalcRotationalInertia()
    found["bodies"][name] = {
        "mass": inertia.get_mass(),
        "com": inertia.get_com().tolist(),
        "inertia": about_com.CopyToFullMatrix3().tolist(),
    }
for name, joint in joints.items():
    if joint.num_positions() == 1:
        low, high = float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])
        found["joints"][name] = {"range": [low, high] if np.isfinite([low, high]).all() else None}
    if joint.num_velocities() in (1, 3):
        found["joints"].setdefault(name, {})["damping"] = float(joint.default_damping_vector()[0])
        found["joints"][name]["armature"] = 0.0
for index in plant.GetJointActuatorIndices(model):
    actuator = plant.get_joint_actuator(index)
    effort = actuator.effort_limit()
    gains = actuator.get_controller_gains() if actuator.has_controller() else None
    found["actuators"][actuator.name()] = {
        "joint": actuator.joint().name(), "kp": gains.p if gains else 0.0, "kd": gains.d if gains else 0.0,
        "effort": [-effort, effort] if np.isfinite(effort) else None,
    }  # fmt: skip
    reflected = actuator.default_rotor_inertia() * actuator.default_gear_ratio() ** 2
    found["joints"][actuator.joint().name()]["armature"] = reflected
inspector = scene.model_inspector()
for body in [plant.world_body(), *bodies.values()]:
    seen = set()  # colliding shapes are shown, too
    for geometry in (*plant.GetCollisionGeometriesForBody(body), *plant.GetVisualGeometriesForBody(body)):
        if (name := inspector.GetName(geometry)) not in seen:
            seen.add(name)
            kind = type(inspector.GetShape(geometry)).__name__
            kind = SHAPES.get(kind, kind.lower())
            found["shapes"][kind] = found["shapes"].get(kind, 0) + 1


def stand(pose):
    for name, value in pose["joints"].items():
        if name in joints and joints[name].num_positions() == 1:
            positions = plant.GetPositions(context)
            positions[joints[name].position_start()] = value[0]
            plant.SetPositions(context, positions)
    for name, value in pose["free"].items():
        if name in bodies:
            positions = plant.GetPositions(context)
            start = bodies[name].floating_positions_start()
            positions[start : start + 4] = value[3:]
            positions[start + 4 : start + 7] = value[:3]
            plant.SetPositions(context, positions)


for pose in asked["poses"]:
    stand(pose)
    row = {}
    for name, body in bodies.items():
        at = plant.EvalBodyPoseInWorld(context, body)
        row[name] = [at.translation().tolist(), at.rotation().matrix().tolist()]
    found["poses"].append(row)
if asked["seconds"]:
    found["motion"], found["without"] = {}, []
    stand(asked["home"])
    q, v = plant.GetPositions(context), np.zeros(plant.num_velocities())
    damping = np.zeros(plant.num_velocities())
    for joint in joints.values():
        damping[joint.velocity_start() : joint.velocity_start() + joint.num_velocities()] = (
            joint.default_damping_vector()
        )
    for _ in range(round(asked["seconds"] / STEP)):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        mass = plant.CalcMassMatrix(context)
        force = plant.CalcGravityGeneralizedForces(context) - plant.CalcBiasTerm(context) - damping * v
        v = v + STEP * np.linalg.solve(mass + STEP * np.diag(damping), force)
        q = q + STEP * plant.MapVelocityToQDot(context, v)
    for name, joint in joints.items():
        if joint.num_positions() == 1:
            found["motion"][name] = float(q[joint.position_start()])
json.dump(found, open(sys.argv[3], "w"))
