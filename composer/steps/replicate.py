"""Where the copies of a part are, as MuJoCo's `<replicate>` has it."""

from __future__ import annotations

from functools import lru_cache

from composer.plan.plan import AttachPart
from composer.pose import ORIGIN, Pose, Vec3, quat_from_euler, rotate
from composer.steps.elements import Making, in_radians, plain


def copy_pose(step: AttachPart, making: Making) -> Pose:
    """The pose of a copy in the frame of the first one; each axis stands in the frame of the one before it."""
    pose = Pose()
    reading = making.readings.at((*step.at, "replicate"))
    for number, axis in zip(step.copy, step.attachment.replicate, strict=True):
        x, y, z = (plain(value) for value in axis.offset)
        angles = tuple(in_radians(angle, reading) for angle in axis.euler)
        pose = pose @ _row(axis.count, (x, y, z), angles, reading.eulerseq)[number]
    return pose


@lru_cache(maxsize=16)  # every copy asks for the same rows
def _row(count: int, offset: Vec3, angles: tuple[float, ...], sequence: str) -> tuple[Pose, ...]:
    """Copy N is turned by N times each angle; the way to the next copy is `offset` in the frame of this one."""
    row: list[Pose] = []
    pos = ORIGIN
    for number in range(count):
        row.append(Pose(pos, quat_from_euler([number * angle for angle in angles], sequence)))
        x, y, z = rotate(row[-1].quat, offset)
        pos = (pos[0] + x, pos[1] + y, pos[2] + z)
    return tuple(row)
