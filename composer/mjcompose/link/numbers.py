"""Numbers and poses of MJCF attributes, bit for bit as in MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lxml.etree import _Element as Node

from mjcompose.base import rotation
from mjcompose.base.rotation import Pose, Quat
from mjcompose.base.words import numbers_text
from mjcompose.tree.classes import ORIENTATIONS
from mjcompose.tree.grammar import NotMjcf
from mjcompose.tree.values import items, real

RADIANS_PER_DEGREE = math.pi / 180


text = numbers_text


def read(text: str) -> list[float]:
    """Parse numbers. Raises NotMjcf for `1_0`, digits of other scripts and `1e400`, which MuJoCo refuses."""
    if not _RARE.isdisjoint(text) or not text.isascii():
        return [real(item) for item in items(text)]
    try:
        values = [float(token) for token in text.split()]
    except ValueError:
        return [real(item) for item in items(text)]
    if math.inf in values or -math.inf in values:
        return [real(item) for item in items(text)]
    return values


# MuJoCo 4.0 reads `timestep="0x1p-8"` as 0.00390625, and refuses `size="1,2"` and `group="1.0"`.
_RARE = frozenset("xX_(")
"""Hexadecimals and `nan(…)`; and characters that only Python reads as part of a number."""


def first(text: str) -> float:
    """Return the first of some numbers. Raises NotMjcf if there is none."""
    return leading(text, 1)[0]


def leading(text: str, count: int) -> list[float]:
    """Return the first numbers. Raises NotMjcf if there are fewer."""
    values = read(text)
    if len(values) < count:
        raise NotMjcf(f"fewer than {count} numbers: {text}")
    return values[:count]


def exactly(text: str, count: int) -> list[float]:
    """Return the numbers. Raises NotMjcf if there are more or fewer."""
    values = read(text)
    if len(values) != count:
        raise NotMjcf(f"not {count} numbers: {text}")
    return values


def integer(text: str) -> int:
    """Parse an integer. Raises NotMjcf."""
    try:
        return int(text)
    except ValueError:
        raise NotMjcf(f"not an integer: {text}") from None


def quat_from_euler(angles: Sequence[float], sequence: str) -> Quat:
    """Convert Euler angles in radians of a source. Raises NotMjcf for another number of angles or another sequence."""
    if len(angles) != len(sequence) or not set(sequence.lower()) <= set("xyz"):
        raise NotMjcf(f"not angles about `{sequence}`: {angles}")
    return rotation.quat_from_euler(angles, sequence)


# MuJoCo 4.0 rounds the two in different ways: `<joint ref="0.30000000000000004"/>` compiles to v * (pi / 180), which is
# not v / 180 * pi to the last bit; `euler` is the other way round.
def orientation_radians(degrees: float) -> float:
    return degrees / 180.0 * math.pi


def joint_radians(degrees: float) -> float:
    """Convert degrees to radians as MuJoCo does for the range and reference of a joint."""
    return degrees * RADIANS_PER_DEGREE


_PLACED = ("body", "frame", "replicate")


def read_pose(attributes: Node | Mapping[str, str], degrees: bool, sequence: str) -> Pose:
    """Return the pose from `pos` and one orientation attribute, with angles in the model's own unit and sequence."""
    # In MuJoCo 4.0, a blank attribute is none: `<body euler=" "/>` is not turned.
    written = {name: str(attributes.get(name) or "").strip() for name in ("pos", *ORIENTATIONS)}
    pos = leading(written["pos"], 3) if written["pos"] else list(rotation.ORIGIN)
    # One of these is written at most: MuJoCo 4.0 says of two "multiple orientation specifiers are not allowed". A
    # `quat` of any length is a rotation: it compiles `quat="2 0 0 0"` to 1 0 0 0.
    quat = (1.0, 0.0, 0.0, 0.0)
    if written["quat"]:
        w, x, y, z = exactly(written["quat"], 4)
        quat = rotation.normalize((w, x, y, z))
    if written["axisangle"]:
        *axis, angle = exactly(written["axisangle"], 4)
        quat = rotation.quat_from_axisangle(axis, orientation_radians(angle) if degrees else angle)
    if written["xyaxes"]:
        quat = rotation.quat_from_xyaxes(exactly(written["xyaxes"], 6))
    if written["zaxis"]:
        quat = rotation.quat_from_zaxis(exactly(written["zaxis"], 3))
    if written["euler"]:
        angles = read(written["euler"])
        quat = quat_from_euler([orientation_radians(angle) for angle in angles] if degrees else angles, sequence)
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
    """Return the pose of a frame in its body or world, that holder, and a `<replicate>` between them."""
    pose = Pose()
    node = element
    copied = None
    while node.tag in ("frame", "replicate"):
        if node.tag == "frame":
            pose = read_pose(node, degrees, sequence) @ pose
        else:
            copied = node
        above = node.getparent()
        assert above is not None
        node = above
    return pose, node, copied
