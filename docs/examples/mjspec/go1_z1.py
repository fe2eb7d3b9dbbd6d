"""The Go1 with motors in its legs carries the Z1 arm with half its gains, and a mast with a camera."""

import os

import mujoco
import numpy as np

menagerie = os.environ["MENAGERIE_ROOT"]
spec = mujoco.MjSpec.from_file(f"{menagerie}/unitree_go1/go1.xml")
spec.modelname = "go1_z1"
arm = mujoco.MjSpec.from_file(f"{menagerie}/unitree_z1/z1_gripper.xml")
spec.option.integrator = arm.option.integrator
legs, trunk = list(spec.actuators), spec.body("trunk")
model = spec.compile()
for leg in legs:
    leg.set_to_motor()
    leg.forcelimited, leg.ctrllimited = model.actuator(leg.name).forcelimited[0], True
    leg.forcerange = leg.ctrlrange = model.actuator(leg.name).forcerange
spec.attach(arm, prefix="arm/", frame=trunk.add_frame(pos=[0.1, 0, 0.06]))
mast = trunk.add_body(name="mast", pos=[-0.15, 0, 0.06])
mast.add_geom(name="mast", type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=[0, 0, 0, 0, 0, 0.3], size=[0.01, 0, 0], mass=0.2)
camera = mast.add_camera(name="mast", pos=[0, 0, 0.32])
camera.alt.type = mujoco.mjtOrientation.mjORIENTATION_EULER
camera.alt.euler = np.deg2rad([0, -110, -90])
for motor in spec.actuators:
    if motor.name.startswith("arm/"):
        motor.gainprm[0] *= 0.5
        motor.biasprm[1:3] *= 0.5

model = spec.compile()
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
for i in range(model.njnt):
    if model.joint(i).name.startswith("arm/"):
        data.joint(i).qpos = model.key("arm/home").qpos[model.jnt_qposadr[i]]
mujoco.mj_forward(model, data)
held = model.actuator_biastype == mujoco.mjtBias.mjBIAS_AFFINE
for key in list(spec.keys):
    spec.delete(key)
spec.add_key(name="home", qpos=data.qpos, ctrl=np.where(held, data.actuator_length, 0))
model = spec.compile()
mujoco.mj_saveModel(model, "build/go1_z1.mjb")
