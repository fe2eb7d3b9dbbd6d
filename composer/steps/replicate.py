"""Where the copies of a part are, as MuJoCo's `<replicate>` has it."""

from __future__ import annotations

from composer.plan.plan import AttachPart
from composer.pose import ORIGIN, Pose, Vec3, quat_from_euler, rotate
from composer.recipe.replicate import Axis
from composer.steps.elements import Making, in_radians, plain


def copy_pose(step: AttachPart, making: Making) -> Pose:
    """The pose of a copy in the frame of the first one; each axis stands in the frame of the one before it."""
    pose = Pose()
    for number, axis in zip(step.copy, step.attachment.replicate, strict=True):
        pose = pose @ _on_axis(number, axis, making)
    return pose


def _on_axis(number: int, axis: Axis, making: Making) -> Pose:
    """Copy N is turned by N times each angle; the way to the next copy is `offset` in the frame of this one."""
    step = [plain(value) for value in axis.offset]
    angles = [in_radians(angle, making) for angle in axis.euler]
    pos: Vec3 = ORIGIN
    for before in range(number):
        x, y, z = rotate(quat_from_euler([before * angle for angle in angles], making.eulerseq), step)
        pos = (pos[0] + x, pos[1] + y, pos[2] + z)
    return Pose(pos, quat_from_euler([number * angle for angle in angles], making.eulerseq))
