"""Two ViperX 300s on a table, three bricks, a cube out of another scene, a weld, a tendon and sensors."""

import os

import mujoco
import numpy as np

menagerie = os.environ["MENAGERIE_ROOT"]
arm_file = f"{menagerie}/trossen_vx300s/vx300s.xml"
spec = mujoco.MjSpec.from_file("recipes/models/scenes/floor.xml")
spec.modelname = "bimanual"
option = mujoco.MjSpec.from_file(arm_file).option
spec.option.cone, spec.option.impratio = option.cone, option.impratio

table = spec.worldbody.add_body(name="table", pos=[0, 0, 0.4])
box = mujoco.mjtGeom.mjGEOM_BOX
table.add_geom(name="top", type=box, size=[0.7, 0.4, 0.02])
left_place = table.add_site(name="left_place", pos=[-0.5, 0, 0.02])
right_place = table.add_site(name="right_place", pos=[0.5, 0, 0.02], quat=[0, 0, 0, 1])
table.add_site(name="middle", pos=[0, 0, 0.02])
spec.attach(mujoco.MjSpec.from_file(arm_file), prefix="left/", site=left_place)
spec.attach(mujoco.MjSpec.from_file(arm_file), prefix="right/", site=right_place)
for i in range(3):
    brick = spec.worldbody.add_body(name=f"brick{i}/brick", pos=[0, -0.1 + 0.1 * i, 0.431])
    brick.add_freejoint()
    brick.add_geom(name=f"brick{i}/brick", type=box, size=[0.03, 0.015, 0.01], mass=0.02)
scene = mujoco.MjSpec.from_file(f"{menagerie}/franka_emika_panda/mjx_single_cube.xml")
scene.body("box").pos = [0.15, 0, 0.45]
spec.worldbody.add_frame().attach_body(scene.body("box"), "cube/", "")

weld = spec.add_equality(name="held", type=mujoco.mjtEq.mjEQ_WELD, active=False)
weld.data[1] = 0  # MjSpec starts from the coefficients of a joint equality
weld.objtype, weld.name1, weld.name2 = mujoco.mjtObj.mjOBJ_BODY, "left/gripper_link", "brick0/brick"
tendon = spec.add_tendon(name="reach")
tendon.wrap_site("left/pinch")
tendon.wrap_site("right/pinch")
kind, obj = mujoco.mjtSensor, mujoco.mjtObj
for name, type, objtype, objname in (
    ("distance", kind.mjSENS_TENDONPOS, obj.mjOBJ_TENDON, "reach"),
    ("left_grip", kind.mjSENS_ACTUATORFRC, obj.mjOBJ_ACTUATOR, "left/gripper"),
    ("right_grip", kind.mjSENS_ACTUATORFRC, obj.mjOBJ_ACTUATOR, "right/gripper"),
):
    spec.add_sensor(name=name, type=type, objtype=objtype, objname=objname)

model = spec.compile()
qpos, ctrl = model.qpos0.copy(), np.zeros(model.nu)
for side in ("left", "right"):
    key = model.key(f"{side}/home")
    joints = [i for i in range(model.njnt) if model.joint(i).name.startswith(f"{side}/")]
    motors = [i for i in range(model.nu) if model.actuator(i).name.startswith(f"{side}/")]
    qpos[model.jnt_qposadr[joints]] = key.qpos[model.jnt_qposadr[joints]]
    ctrl[motors] = key.ctrl[motors]
for key in list(spec.keys):
    spec.delete(key)
spec.add_key(name="home", qpos=qpos, ctrl=ctrl)
model = spec.compile()
mujoco.mj_saveModel(model, "build/bimanual.mjb")
