"""An arm and a hand of MuJoCo Menagerie, each from its own file, as one robot with a table and a cube.

    python docs/examples/arm_and_hand.py OUT.zip

The models come from the package `mujoco-menagerie`, or from the folder that MENAGERIE_ROOT names.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from mjcompose import mjcf

ARM = "universal_robots_ur5e/ur5e.xml"
HAND = "robotiq_2f85/2f85.xml"


def menagerie(path: str) -> mjcf.RootElement:
    """A model of Menagerie by its folder and file."""
    robot, _, file = path.partition("/")
    root = os.environ.get("MENAGERIE_ROOT")
    if root is None:
        import mujoco_menagerie

        return mjcf.from_path(mujoco_menagerie.get(robot).path() / file)
    return mjcf.from_path(Path(root) / robot / file)


def make_cell() -> tuple[mjcf.RootElement, mjcf.RootElement, mjcf.RootElement]:
    """The cell, with the arm on a table and a cube to take; the arm and the hand in it."""
    arm = menagerie(ARM)
    hand = menagerie(HAND)
    arm.find("site", "attachment_site").attach(hand)

    cell = mjcf.RootElement("cell")
    # A model has one of these: what the hand was tuned for has to be said where the model is.
    cell.option.set_attributes(impratio=10, cone="elliptic", integrator="implicitfast")
    cell.worldbody.add("light", pos=[0, 0, 3])
    cell.worldbody.add("camera", name="watch", pos=[1.4, 1, 1.2], xyaxes=[-0.6, 0.8, 0, -0.4, -0.3, 0.9])
    table = cell.worldbody.add("body", name="table", pos=[0, 0, 0.4])
    table.add("geom", name="top", type="box", size=[0.8, 0.8, 0.02], rgba=[0.5, 0.4, 0.3, 1])
    table.add("site", name="mount", pos=[0, 0, 0.02]).attach(arm)
    cube = cell.worldbody.add("body", name="cube", pos=[0.5, 0.13, 0.45])
    cube.add("freejoint")
    cube.add("geom", name="cube", type="box", size=[0.02, 0.02, 0.02], mass=0.05, rgba=[0.8, 0.2, 0.2, 1])
    return cell, arm, hand


def main() -> None:
    cell, arm, hand = make_cell()
    physics = cell.compile_model()
    print("prefix of the hand:", hand.full_identifier)
    print("keyframes:", [key.full_identifier for key in cell.find_all("key")])

    # The arm's own keyframe, by the arm's own names, whatever else is in the cell.
    home = arm.find("key", "home")
    joints = physics.bind(arm.find_all("joint", exclude_attachments=True))
    motors = physics.bind(arm.find_all("actuator", exclude_attachments=True))
    joints.qpos = home.qpos
    motors.ctrl = home.ctrl
    physics.forward()

    fingers = physics.bind([hand.find("joint", f"{side}_driver_joint") for side in ("left", "right")])
    drive = physics.bind(hand.find("actuator", "fingers_actuator"))
    for ctrl in (0, 255):
        drive.ctrl = ctrl
        physics.step(1000)
        print(f"fingers at {ctrl} (rad):", fingers.qpos.round(2))

    if sys.argv[1:]:
        mjcf.export_with_assets_as_zip(cell, sys.argv[1])


if __name__ == "__main__":
    main()
