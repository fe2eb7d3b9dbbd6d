"""The Panda with the Allegro hand, and a key that grasps and holds."""

import os

import mujoco
import numpy as np

menagerie = os.environ["MENAGERIE_ROOT"]
spec = mujoco.MjSpec.from_file(f"{menagerie}/franka_emika_panda/panda_nohand.xml")
spec.modelname = "panda_allegro"
hand = mujoco.MjSpec.from_file(f"{menagerie}/wonik_allegro/left_hand.xml")
spec.option.cone, spec.option.impratio = hand.option.cone, hand.option.impratio
s = np.sqrt(0.5)
flange = spec.site("attachment_site").parent
carrier = flange.add_body(name="hand/sense")
carrier.add_site(name="hand/sense")
spec.attach(hand, prefix="hand/", frame=carrier.add_frame(pos=[0, 0, 0.095], quat=[s, 0, -s, 0]))
for name, kind in {"force": mujoco.mjtSensor.mjSENS_FORCE, "torque": mujoco.mjtSensor.mjSENS_TORQUE}.items():
    sensor = spec.add_sensor(name=f"hand/{name}", type=kind)
    sensor.objtype, sensor.objname = mujoco.mjtObj.mjOBJ_SITE, "hand/sense"

model = spec.compile()
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
for joint, angle in {"ffj1": 60, "mfj1": 60, "rfj1": 60, "thj0": 70}.items():
    data.joint(f"hand/{joint}").qpos = np.deg2rad(angle)
mujoco.mj_forward(model, data)
spec.delete(spec.key("home"))
spec.add_key(name="home", qpos=model.key("home").qpos, ctrl=model.key("home").ctrl)
spec.add_key(name="grasp", qpos=data.qpos, ctrl=data.actuator_length)
model = spec.compile()
mujoco.mj_saveModel(model, "build/panda_allegro.mjb")
