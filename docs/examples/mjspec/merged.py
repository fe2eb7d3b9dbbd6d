"""The UR5e with the 2F-85, grippier pads, less elbow and a floor."""

import os

import mujoco

menagerie = os.environ["MENAGERIE_ROOT"]
spec = mujoco.MjSpec.from_file(f"{menagerie}/universal_robots_ur5e/ur5e.xml")
spec.modelname = "merged"
gripper = mujoco.MjSpec.from_file(f"{menagerie}/robotiq_2f85/2f85.xml")
spec.option.cone, spec.option.impratio = gripper.option.cone, gripper.option.impratio
spec.attach(gripper, prefix="gripper_", site=spec.site("attachment_site"))
for geom in spec.geoms:
    if geom.classname.name.startswith("gripper_pad_box"):
        geom.friction[0] = 1.2
spec.joint("elbow_joint").range = [-2, 2]
spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.05])
model = spec.compile()
mujoco.mj_saveModel(model, "build/merged.mjb")
