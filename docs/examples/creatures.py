"""Creatures with random legs on an arena: models made by functions, attached to one another two levels deep.

    python docs/examples/creatures.py [PICTURE.png]

Without a display `MUJOCO_GL=egl` has to be set for the picture.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from mjcompose import mjcf
from mjcompose.mujoco.film import png

RADIUS = 0.1  # of a creature's trunk, in meters
LEGS = 3, 4, 4, 5, 6, 6


def make_leg(name: str, length: float, color: list[float]) -> mjcf.RootElement:
    """Thigh and shin of one length, each moved by a servo."""
    leg = mjcf.RootElement(name)
    leg.default.geom.set_attributes(type="capsule", rgba=color)
    leg.default.joint.set_attributes(damping=2, type="hinge")
    leg.default.position.kp = 15

    thigh = leg.worldbody.add("body", name="thigh")
    hip = thigh.add("joint", name="hip", axis=[0, 0, 1])
    thigh.add("geom", fromto=[0, 0, 0, length, 0, 0], size=[length / 4])
    shin = thigh.add("body", name="shin", pos=[length, 0, 0])
    knee = shin.add("joint", name="knee", axis=[0, 1, 0])
    shin.add("geom", fromto=[0, 0, 0, 0, 0, -length], size=[length / 5])
    for joint in (hip, knee):
        leg.actuator.add("position", name=joint.name, joint=joint)
    return leg


def make_creature(name: str, legs: int, random: np.random.Generator) -> mjcf.RootElement:
    """A flat trunk with legs all around, in a color and with a length of leg of its own."""
    color = [*random.uniform(0.2, 1, 3), 1]
    length = random.uniform(0.6, 1.2) * RADIUS
    creature = mjcf.RootElement(name)
    creature.compiler.angle = "radian"
    trunk = creature.worldbody.add("geom", name="trunk", type="ellipsoid", size=[RADIUS, RADIUS, RADIUS / 2])
    trunk.rgba = color
    for number in range(legs):
        turn = 2 * np.pi * number / legs
        hip = creature.worldbody.add("site", pos=RADIUS * np.array([np.cos(turn), np.sin(turn), 0]), euler=[0, 0, turn])
        hip.attach(make_leg(f"leg{number}", length, color))
    return creature


def make_arena(creatures: list[mjcf.RootElement]) -> mjcf.RootElement:
    """A floor with light, and the creatures in two rows above it, free to move."""
    arena = mjcf.RootElement("arena")
    checker = arena.asset.add(
        "texture",
        name="checker",
        type="2d",
        builtin="checker",
        width=300,
        height=300,
        rgb1=[0.2, 0.3, 0.4],
        rgb2=[0.3, 0.4, 0.5],
    )
    grid = arena.asset.add("material", name="grid", texture=checker, texrepeat=[5, 5], reflectance=0.2)
    arena.worldbody.add("geom", name="floor", type="plane", size=[2, 2, 0.1], material=grid)
    for x in (-2, 2):
        arena.worldbody.add("light", pos=[x, -1, 3], dir=[-x, 1, -2])
    arena.worldbody.add("camera", name="watch", pos=[0, -1.6, 1.2], xyaxes=[1, 0, 0, 0, 0.6, 0.8])
    for number, creature in enumerate(creatures):
        place = arena.worldbody.add("site", pos=[0.6 * (number % 3 - 1), 0.6 * (number // 3) - 0.3, 0.2])
        place.attach(creature).add("freejoint")
    return arena


def main() -> None:
    random = np.random.default_rng(42)
    creatures = [make_creature(f"creature{n}", legs, random) for n, legs in enumerate(LEGS)]
    arena = make_arena(creatures)
    physics = arena.compile_model()
    print(f"{len(LEGS)} creatures, {physics.model.nu} servos, {physics.model.nv} degrees of freedom")

    servos = physics.bind(arena.find_all("actuator"))
    trunks = physics.bind([mjcf.get_attachment_frame(creature) for creature in creatures])
    start = trunks.xpos.copy()
    phase = random.uniform(0, 2 * np.pi, physics.model.nu)
    while physics.time < 3:
        servos.ctrl = 0.6 * np.sin(10 * physics.time + phase)
        physics.step()
    physics.forward()
    walked = np.linalg.norm((trunks.xpos - start)[:, :2], axis=1)
    print("walked (m):", walked.round(2))

    if sys.argv[1:]:
        Path(sys.argv[1]).write_bytes(png(physics.render(480, 640, "watch")))


if __name__ == "__main__":
    main()
