"""Facts of a model as Drake reads it: `python drake.py MODEL POSES.json FACTS.json`."""

import json
import sys
from importlib.metadata import version

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

plant = MultibodyPlant(0.0)
(model,) = Parser(plant).AddModels(sys.argv[1])[:1]
plant.Finalize()
context = plant.CreateDefaultContext()
bodies = {plant.get_body(i).name(): plant.get_body(i) for i in plant.GetBodyIndices(model)}
joints = {plant.get_joint(i).name(): plant.get_joint(i) for i in plant.GetJointIndices(model)}

found = {"version": version("drake"), "bodies": {}, "joints": {}, "actuators": {}, "poses": []}
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
for index in plant.GetJointActuatorIndices(model):
    actuator = plant.get_joint_actuator(index)
    effort = actuator.effort_limit()
    found["actuators"][actuator.name()] = {
        "joint": actuator.joint().name(),
        "effort": effort if np.isfinite(effort) else None,
    }
for pose in json.load(open(sys.argv[2])):
    for name, value in pose["joints"].items():
        if name in joints and joints[name].num_positions() == 1:
            plant.SetPositions(context, np.array(plant.GetPositions(context)))
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
    row = {}
    for name, body in bodies.items():
        at = plant.EvalBodyPoseInWorld(context, body)
        row[name] = [at.translation().tolist(), at.rotation().matrix().tolist()]
    found["poses"].append(row)
with open(sys.argv[3], "w") as file:
    json.dump(found, file)
