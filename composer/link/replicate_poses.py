"""The poses of the copies of a `<replicate>`."""

from __future__ import annotations

from functools import lru_cache

from composer.link.numbers import orientation_radians
from composer.numerics.pose import ORIGIN, Pose, Vec3, quat_from_euler, rotate


@lru_cache(maxsize=16)  # every copy of a part asks for the same rows
def row(
    count: int, offset: Vec3, angles: tuple[float, ...], sequence: str, *, degrees: bool = False
) -> tuple[Pose, ...]:
    """Return the poses of all copies. Copy N is turned by N times each angle; the next is at `offset` in its frame."""
    made: list[Pose] = []
    pos = ORIGIN
    for number in range(count):
        turns = [number * angle for angle in angles]
        if degrees:
            turns = [orientation_radians(turn) for turn in turns]
        made.append(Pose(pos, quat_from_euler(turns, sequence)))
        x, y, z = rotate(made[-1].quat, offset)
        pos = (pos[0] + x, pos[1] + y, pos[2] + z)
    return tuple(made)
