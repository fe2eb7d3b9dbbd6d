"""The bounding volumes of bodies, which MuJoCo computes when it compiles a model, and which no later step corrects."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, TypeAlias

import mujoco
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Box: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64]]
"""The lower and the upper corner."""


def set_volumes(model: MjModel, bodies: Iterable[int], absent: Collection[int] = ()) -> None:
    """Compute `bvh_aabb` of bodies from poses and boxes of geoms; the boxes of `absent` geoms are empty.

    The boxes are in the inertial frame of the body. MuJoCo 4.0 compares them to find geoms that are near each other, so
    it misses contacts if they are those of another geom.
    """
    for body in bodies:
        _set_volumes_of(model, body, nodes_of(model, body), absent=absent)


def nodes_of(model: MjModel, body: int) -> range:
    """Return the rows of a body's volumes."""
    first = int(model.body_bvhadr[body])
    return range(first, first + int(model.body_bvhnum[body]))


def _set_volumes_of(model: MjModel, body: int, nodes: range, absent: Collection[int]) -> None:
    boxes: dict[int, Box | None] = {}
    for node in reversed(nodes):  # children come after their parents
        geom = int(model.bvh_nodeid[node])
        if geom >= 0:
            boxes[node] = None if geom in absent else _box_in_body(model, body, geom)
        else:
            children = [boxes[nodes.start + int(child)] for child in model.bvh_child[node] if child >= 0]
            boxes[node] = _around([child for child in children if child is not None])
    for node, box in boxes.items():
        low, high = (np.zeros(3), np.zeros(3)) if box is None else box
        model.bvh_aabb[node] = np.concatenate(((low + high) / 2, (high - low) / 2))


def _around(boxes: list[Box]) -> Box | None:
    if not boxes:
        return None
    return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


def _box_in_body(model: MjModel, body: int, geom: int) -> Box:
    inertial = _matrix(model.body_iquat[body])
    turn = _matrix(model.geom_quat[geom])
    center, half = model.geom_aabb[geom].reshape(2, 3)
    middle = inertial.T @ (model.geom_pos[geom] + turn @ center - model.body_ipos[body])
    extent = np.abs(inertial.T @ turn) @ half
    return middle - extent, middle + extent


def _matrix(quat: NDArray[np.float64]) -> NDArray[np.float64]:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quat)
    return matrix.reshape(3, 3)
