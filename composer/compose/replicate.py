"""The poses of the copies of a part, computed as by MuJoCo's `<replicate>`."""

from __future__ import annotations

from composer.compose.elements import ElementBuilder, in_radians, plain
from composer.link.replicate_poses import row
from composer.numerics.pose import Pose
from composer.plan.plan import AttachPart


def copy_pose(step: AttachPart, making: ElementBuilder) -> Pose:
    """Return the pose of a copy in the frame of the first one. Each axis is in the frame of the one before it."""
    pose = Pose()
    settings = making.angle_context.at((*step.at, "replicate"))
    for number, axis in zip(step.copy, step.attachment.replicate, strict=True):
        x, y, z = (plain(value) for value in axis.offset)
        angles = tuple(in_radians(angle, settings) for angle in axis.euler)
        pose = pose @ row(axis.count, (x, y, z), angles, sequence=settings.eulerseq)[number]
    return pose
