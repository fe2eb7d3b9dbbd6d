"""The types of joint: the sizes of their state, and units.

MuJoCo uses radians and metres. A quaternion has no unit; its numbers have the word for one.
"""

from __future__ import annotations

from composer.dataclass import dataclass

ANGLE, LENGTH, QUATERNION = "rad", "m", "quaternion"

FREE, BALL, SLIDE, HINGE = range(4)
"""The values of `jnt_type`."""


@dataclass(frozen=True, slots=True)
class JointType:
    """A type of joint.

    `position_units` has the unit of each number in `qpos`, `velocity_units` those in `qvel`. `range_unit` is that
    of `jnt_range`, which MuJoCo does not use for a free joint. The linear numbers of a free joint precede the
    angular ones; its linear velocity is in the world's frame, its angular velocity in the body's own.
    """

    word: str
    position_units: tuple[str, ...]
    velocity_units: tuple[str, ...]
    range_unit: str | None

    @property
    def positions(self) -> int:
        """The number of its entries in `qpos`."""
        return len(self.position_units)

    @property
    def velocities(self) -> int:
        """The number of its degrees of freedom: entries of `qvel`, rows of the `dof_` arrays."""
        return len(self.velocity_units)

    @property
    def unit(self) -> str | None:
        """The common unit of all its positions."""
        return _common(self.position_units)

    @property
    def velocity_unit(self) -> str | None:
        """The common unit of all its velocities."""
        return _common(self.velocity_units)

    @property
    def coordinate(self) -> str | None:
        """The unit of its position, if that is a single number."""
        return self.unit if self.positions == 1 else None


def _common(units: tuple[str, ...]) -> str | None:
    return units[0] if len(set(units)) == 1 else None


JOINT_TYPES = (
    JointType("free", (LENGTH,) * 3 + (QUATERNION,) * 4, ("m/s",) * 3 + ("rad/s",) * 3, range_unit=None),
    JointType("ball", (QUATERNION,) * 4, ("rad/s",) * 3, range_unit=ANGLE),
    JointType("slide", (LENGTH,), ("m/s",), range_unit=LENGTH),
    JointType("hinge", (ANGLE,), ("rad/s",), range_unit=ANGLE),
)
"""By `jnt_type`."""

BY_WORD = {each.word: each for each in JOINT_TYPES}
ANGULAR = tuple(each.word for each in JOINT_TYPES if each.range_unit == ANGLE)
"""Rotational joints, whose ranges are angles."""
