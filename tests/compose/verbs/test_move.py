"""The verb `move`."""

from __future__ import annotations

import mujoco
from compose.arm import Case


def test_a_body_that_moves_keeps_the_class_around_it(radian: Case, own: bool) -> None:
    """Its geoms and joints name no class: the `childclass` of the old place goes with it."""
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    after = radian.edited("{select: {body: link2}, move: {to: world}}", own)
    for model in (before, after):
        assert model.geom("lower").friction[0] == 0.8 and model.geom("lower").type[0] == mujoco.mjtGeom.mjGEOM_CAPSULE
        assert model.joint("elbow").damping[0] == 2 and model.joint("elbow").axis.tolist() == [0, 1, 0]
