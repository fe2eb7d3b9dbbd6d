"""Poses: positions in metres with rotation matrices."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Pose = tuple[Any, Any]
"""Position, shape (3,), and rotation matrix, shape (3, 3)."""


def pose(pos: Any, quat: Any = (1.0, 0.0, 0.0, 0.0)) -> Pose:
    """Return the pose with a position (m) and a quaternion (w, x, y, z), which is normalised."""
    w, x, y, z = (float(each) for each in np.asarray(quat) / np.linalg.norm(quat))
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.asarray(pos, dtype=float), np.array(rows)


def about(axis: Any, angle: float) -> Pose:
    """Return the rotation by an angle (rad) about an axis through the origin."""
    half = angle / 2
    return pose((0, 0, 0), (math.cos(half), *(math.sin(half) * np.asarray(axis))))


def shifted(by: Any) -> Pose:
    return np.asarray(by, dtype=float), np.eye(3)


def joined(*poses: Pose) -> Pose:
    """Return the product of poses: each one is in the frame of the one before it."""
    at, turned = shifted((0, 0, 0))
    for pos, rotation in poses:
        at, turned = at + turned @ pos, turned @ rotation
    return at, turned


def back(of: Pose) -> Pose:
    """Return the inverse of a pose."""
    return -(of[1].T @ of[0]), of[1].T


def quat(turned: Any) -> Any:
    """Return the quaternion (w, x, y, z) of a rotation matrix, shape (4,).

    >>> [round(float(each), 6) for each in quat(about((0, 0, 1), 1.0)[1])]
    [0.877583, 0.0, 0.0, 0.479426]
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = turned
    squares = np.array([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz])
    mixed = np.array(
        [
            [squares[0], zy - yz, xz - zx, yx - xy],
            [zy - yz, squares[1], yx + xy, xz + zx],
            [xz - zx, yx + xy, squares[2], zy + yz],
            [yx - xy, xz + zx, zy + yz, squares[3]],
        ]
    )
    row = mixed[int(squares.argmax())]
    return row / np.linalg.norm(row)
