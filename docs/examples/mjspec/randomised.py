"""Eight samples of an arm and three cubes, as models and as a table."""

import csv
import json
import os

import mujoco
import numpy as np

menagerie = os.environ["MENAGERIE_ROOT"]
SEED, SAMPLES = 1, 8


def nominal():
    spec = mujoco.MjSpec.from_file(f"{menagerie}/universal_robots_ur5e/ur5e.xml")
    spec.modelname = "randomised"
    motors = [motor.name for motor in spec.actuators]
    gripper = mujoco.MjSpec.from_file(f"{menagerie}/robotiq_2f85/2f85.xml")
    spec.option.cone, spec.option.impratio = gripper.option.cone, gripper.option.impratio
    table = mujoco.MjSpec.from_file("recipes/models/table/table.xml")
    spec.attach(table, prefix="table/", frame=spec.worldbody.add_frame(pos=[0.6, 0, 0]))
    spec.attach(gripper, prefix="gripper/", site=spec.site("attachment_site"))
    for i in range(3):
        cube = mujoco.MjSpec.from_file("recipes/models/props/cube.xml")
        frame = spec.worldbody.add_frame(pos=[0.5, -0.1 + 0.1 * i, 0.75])
        for geom in cube.geoms:
            geom.priority = 2
        spec.attach(cube, prefix=f"cube{i}/", frame=frame)
    spec.worldbody.add_camera(name="overhead", pos=[0.6, 0, 1.8])
    return spec, motors


def drawn(sample, motors):
    """What one sample draws, by column of the table."""
    stream = np.random.default_rng([SEED, sample])
    draws = {}
    for i in range(3):
        draws[f"friction[cube{i}]"] = stream.uniform(0.4, 1.2)
        draws[f"mass[cube{i}]"] = np.exp(stream.uniform(np.log(0.5), np.log(2)))
    for motor in motors:
        draws[f"gain[{motor}]"] = draws[f"bias[{motor}]"] = stream.uniform(0.8, 1.2)
    for i in range(3):
        draws[f"camera[overhead][{i}]"] = stream.normal(0, 0.01)
    draws["view[overhead]"] = stream.normal(0, 1)
    return draws


def bake(spec, draws, motors):
    for i in range(3):
        for geom in spec.body(f"cube{i}/cube").geoms:
            geom.friction[0] = draws[f"friction[cube{i}]"]
            geom.mass *= draws[f"mass[cube{i}]"]
    for name in motors:
        spec.actuator(name).gainprm[0] *= draws[f"gain[{name}]"]
        spec.actuator(name).biasprm[1] *= draws[f"bias[{name}]"]
    spec.camera("overhead").pos += [draws[f"camera[overhead][{i}]"] for i in range(3)]
    spec.camera("overhead").fovy += draws["view[overhead]"]


def targets(model, motors):
    """The numbers of mjModel that each column of the table changes at run time."""
    columns = {}
    for i in range(3):
        body = model.body(f"cube{i}/cube").id
        geoms = [int(g) for g in np.flatnonzero(model.geom_bodyid == body)]
        columns[f"friction[cube{i}]"] = ("set", [("geom_friction", [g, 0]) for g in geoms])
        inertia = [("body_inertia", [body, k]) for k in range(3)]
        columns[f"mass[cube{i}]"] = ("scale", [("body_mass", [body]), *inertia])
    for name in motors:
        columns[f"gain[{name}]"] = ("scale", [("actuator_gainprm", [model.actuator(name).id, 0])])
        columns[f"bias[{name}]"] = ("scale", [("actuator_biasprm", [model.actuator(name).id, 1])])
    camera = model.camera("overhead").id
    for i in range(3):
        columns[f"camera[overhead][{i}]"] = ("offset", [("cam_pos", [camera, i])])
    columns["view[overhead]"] = ("offset", [("cam_fovy", [camera])])
    return columns


rows = []
for sample in range(SAMPLES + 1):
    spec, motors = nominal()
    draws = drawn(sample, motors) if sample else {}
    if sample:
        bake(spec, draws, motors)
    spec.modelname = f"randomised-s{sample:04}"
    model = spec.compile()
    mujoco.mj_saveModel(model, f"build/{spec.modelname}.mjb")
    rows.append({"model": spec.modelname, "sample": sample, **draws})
with open("build/samples.csv", "w", newline="") as file:
    table = csv.DictWriter(file, list(rows[-1]))
    table.writeheader()
    table.writerows(rows)
spec, motors = nominal()
model = spec.compile()
with open("build/randomize.json", "w") as file:
    json.dump(targets(model, motors), file)
