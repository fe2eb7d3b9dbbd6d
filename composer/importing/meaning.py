"""Compare poses, angles and rounded numbers that are written differently."""

from __future__ import annotations

import math
from collections.abc import Mapping

from composer.importing.likeness import near
from composer.link.numbers import read
from composer.link.placing import read_pose
from composer.numerics.pose import Pose, quat_from_zaxis
from composer.tree.settings import Settings

POSE = frozenset({"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fromto"})
_ANGLES = ("range", "ref", "springref", "springyield")


def plain(values: Mapping[str, str], tag: str, settings: Settings, degrees: bool) -> dict[str, str]:
    """Return the values with joint angles in the given unit."""
    found = dict(values)
    slides = tag == "joint" and found.get("type") == "slide"
    if tag != "joint" or slides or (settings.angle == "degree") == degrees:
        return found
    factor = 180 / math.pi if degrees else math.pi / 180
    for name in _ANGLES:
        if name in found:
            found[name] = " ".join(f"{number * factor:.12g}" for number in read(found[name]))
    return found


def placed(values: Mapping[str, str], settings: Settings) -> tuple[Pose, list[float]] | None:
    """Return the pose and size that the values describe, or None if they are not numbers."""
    try:
        pose, size = (
            read_pose(values, settings.angle == "degree", settings.eulerseq),
            read(values.get("size", "")),
        )
        if not values.get("fromto"):
            return pose, size
        ends = read(values["fromto"])
        middle = [(a + b) / 2 for a, b in zip(ends[:3], ends[3:], strict=True)]
        axis = [a - b for a, b in zip(ends[:3], ends[3:], strict=True)]
        half = math.dist(ends[:3], ends[3:]) / 2
        boxed = values.get("type") in ("box", "ellipsoid")
        size = [size[0], size[0], half] if boxed else [size[0], half]
        return Pose((middle[0], middle[1], middle[2]), quat_from_zaxis(axis)), size
    except (ValueError, IndexError):
        return None


def at_the_same_place(
    one: Mapping[str, str], settings: Settings, other: Mapping[str, str], others: Settings
) -> bool:
    """Return whether two elements have the same pose and size except for rounding, however they are written."""
    here, there = placed(one, settings), placed(other, others)
    if here is None or there is None or len(here[1]) != len(there[1]):
        return False
    quats = (list(here[0].quat), list(there[0].quat))
    return (
        near(list(here[0].pos), list(there[0].pos))
        and (near(*quats) or near(quats[0], [-each for each in quats[1]]))
        and near(here[1], there[1])
    )


def is_rounded(exact: float, written: float) -> bool:
    """Return whether one number is the other, or the other rounded to the six digits that MuJoCo writes.

    >>> is_rounded(1.5707963267948966, 1.5708), is_rounded(1.5707963267948966, 1.571)
    (True, False)
    """
    return exact == written or float(f"{exact:.6g}") == written
