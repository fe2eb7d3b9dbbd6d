"""Poses in the reference configuration, computed from the tree."""

from __future__ import annotations

from collections.abc import Mapping

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.numerics.pose import (
    ORIGIN,
    Pose,
    normalise,
    quat_from_axisangle,
    quat_from_euler,
    quat_from_xyaxes,
    quat_from_zaxis,
)

_PLACED = ("body", "frame", "replicate")


def read_pose(attributes: Node | Mapping[str, str], degrees: bool, sequence: str) -> Pose:
    """Return the pose from `pos` and one orientation attribute, with angles in the model's own unit and sequence."""
    get = attributes.get
    pos = numbers.read(str(get("pos") or "")) or list(ORIGIN)
    # One of these is written at most: MuJoCo 4.0 says of two "multiple orientation specifiers are not allowed". A
    # `quat` of any length is a rotation: it compiles `quat="2 0 0 0"` to 1 0 0 0.
    quat = (1.0, 0.0, 0.0, 0.0)
    if get("quat"):
        w, x, y, z = numbers.read(str(get("quat")))
        quat = normalise((w, x, y, z))
    if get("axisangle"):
        *axis, angle = numbers.read(str(get("axisangle")))
        quat = quat_from_axisangle(axis, numbers.orientation_radians(angle) if degrees else angle)
    if get("xyaxes"):
        quat = quat_from_xyaxes(numbers.read(str(get("xyaxes"))))
    if get("zaxis"):
        quat = quat_from_zaxis(numbers.read(str(get("zaxis"))))
    if get("euler"):
        angles = numbers.read(str(get("euler")))
        quat = quat_from_euler(map(numbers.orientation_radians, angles) if degrees else angles, sequence)  # type: ignore[arg-type]
    return Pose((pos[0], pos[1], pos[2]), quat)


def pose_in_world(element: Node, degrees: bool, sequence: str) -> Pose:
    """Return the pose of a body, frame or the world in the world, with all joints at their reference."""
    pose = Pose()
    node: Node | None = element
    while node is not None and node.tag in _PLACED:
        below, node, _ = pose_below(node, degrees, sequence)
        pose = below @ pose
        if node.tag == "body":
            pose = read_pose(node, degrees, sequence) @ pose
            node = node.getparent()
    return pose


def pose_below(element: Node, degrees: bool, sequence: str) -> tuple[Pose, Node, Node | None]:
    """Return the pose of a frame in the body or the world that holds it, this one, and a `<replicate>` between them."""
    pose, node, copied = Pose(), element, None
    while node.tag in ("frame", "replicate"):
        if node.tag == "frame":
            pose = read_pose(node, degrees, sequence) @ pose
        else:
            copied = node
        above = node.getparent()
        assert above is not None
        node = above
    return pose, node, copied
