"""Poses as URDF writes them: positions in metres, and angles in radians about the fixed axes x, y and z."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.plain.numbers import text
from composer.targets.poses import Pose


def origin(of: Pose) -> Node:
    """Return the element `<origin>`."""
    return etree.Element("origin", xyz=text(_clean(of[0])), rpy=text(_clean(angles(of[1]))))


def angles(turned: Any) -> Any:
    """Return roll, pitch and yaw (rad) of a rotation matrix, shape (3,).

    >>> [round(float(each), 6) for each in angles([[0, -1, 0], [1, 0, 0], [0, 0, 1]])]
    [0.0, 0.0, 1.570796]
    """
    level = math.hypot(turned[0][0], turned[1][0])
    pitch = math.atan2(-turned[2][0], level)
    if level < 1e-9:  # looks straight up or down: yaw and roll are about one axis
        return np.array([math.atan2(-turned[1][2], turned[1][1]), pitch, 0.0])
    return np.array([math.atan2(turned[2][1], turned[2][2]), pitch, math.atan2(turned[1][0], turned[0][0])])


def _clean(values: Any) -> Any:
    return np.where(np.abs(values) < 1e-16, 0.0, values)
