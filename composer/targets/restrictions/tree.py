"""Limits about the tree of bodies: one body in the world, one joint in each body, no joint references.

The model moves as before.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome
from composer.targets.plain.numbers import text
from composer.targets.poses import Pose, about, back, joined, pose, quat, shifted

NAME = "world_root"
_EMPTY = {"mass": "0", "pos": "0 0 0", "quat": "1 0 0 0", "diaginertia": "0 0 0"}


def one_root(*, with_free: bool) -> Limit:
    """Return a limit that puts the bodies of the world into one.

    It is for a target that reads one body in the world, or places it by its centre of mass. Bodies with a free joint
    are moved only `with_free`, because MuJoCo does not read them there.
    """
    return Limit("roots", Outcome.WRITTEN, partial(_one_root, with_free))


def _one_root(with_free: bool, draft: Draft) -> None:
    for world in draft.root.iterfind("worldbody"):
        bodies = list(world.iterchildren("body"))
        free = [body for body in bodies if _is_free(body)]
        if with_free and len(bodies) == 1 and free:
            continue
        held = bodies if with_free else [body for body in bodies if body not in free]
        if not held:
            continue
        draft.mujoco_reads &= not (with_free and free)  # MJCF has free joints at the top alone
        root = etree.SubElement(world, "body", name=NAME, pos="0 0 0", quat="1 0 0 0")
        etree.SubElement(root, "inertial", _EMPTY)
        root.extend(held)
        for body in held:
            draft.lose(
                "roots", body, f"a body `{NAME}` holds the bodies of the world", outcome=Outcome.WRITTEN
            )


def _is_free(body: Node) -> bool:
    joints = body.iterchildren("joint", "freejoint")
    return any(each.tag == "freejoint" or each.get("type") == "free" for each in joints)


def single_joints(mass: str = "0") -> Limit:
    """Return a limit that gives each further joint of a body a body of its own, with this mass (kg) and inertia."""
    return Limit("joints", Outcome.WRITTEN, partial(_split, mass))


def _split(mass: str, draft: Draft) -> None:
    for body in list(draft.root.iterfind(".//body")):
        joints = list(body.iterchildren("joint"))
        holder = body.getparent()
        if len(joints) < 2 or holder is None:
            continue
        draft.mujoco_reads &= mass != "0"  # nothing that moves may be without a mass there
        draft.lose("joints", body, "each joint but the last has a body of its own", outcome=Outcome.WRITTEN)
        at = holder.index(body)
        place = {"pos": str(body.get("pos")), "quat": str(body.get("quat"))}
        for joint in joints[:-1]:
            between = etree.Element("body", {"name": f"{body.get('name')}__{joint.get('name')}", **place})
            etree.SubElement(
                between, "inertial", _EMPTY | {"mass": mass, "diaginertia": f"{mass} {mass} {mass}"}
            )
            between.append(joint)
            holder.insert(at, between)
            holder, at, place = between, len(between), {"pos": "0 0 0", "quat": "1 0 0 0"}
        body.set("pos", place["pos"])
        body.set("quat", place["quat"])
        holder.append(body)


def _zeroed(draft: Draft) -> None:
    """Place bodies where their joints are at zero."""
    for body in draft.root.iterfind(".//body"):
        joints = [each for each in body.iterchildren("joint") if each.get("type") in ("hinge", "slide")]
        if not any(_reference(each) for each in joints):
            continue
        stands = pose(_numbers(body, "pos"), _numbers(body, "quat"))
        behind = shifted((0, 0, 0))
        for joint in reversed(joints):
            to_zero = _moved(joint, -_reference(joint))
            _carry(joint, back(behind))
            behind = joined(to_zero, behind)
        at, turned = joined(stands, behind)
        body.set("pos", text(at))
        body.set("quat", text(quat(turned)))
        for joint in joints:
            if joint.attrib.pop("ref", ""):
                draft.lose(
                    "references",
                    joint,
                    "their bodies are where the joints are at zero",
                    outcome=Outcome.WRITTEN,
                )


def _moved(joint: Node, by: float) -> Pose:
    """Return the motion of a joint's body, in its frame, when the joint moves by an angle (rad) or a distance (m)."""
    anchor, axis = shifted(_numbers(joint, "pos")), _numbers(joint, "axis")
    if joint.get("type") == "slide":
        return shifted(by * axis)
    return joined(anchor, about(axis, by), back(anchor))


def _carry(joint: Node, by: Pose) -> None:
    """Transform the position and axis of a joint by a pose, because the frame of its body has moved."""
    joint.set("pos", text(by[0] + by[1] @ _numbers(joint, "pos")))
    joint.set("axis", text(by[1] @ _numbers(joint, "axis")))


def _reference(joint: Node) -> float:
    return float(joint.get("ref") or 0)


def _numbers(element: Node, name: str) -> Any:
    return np.array([float(each) for each in str(element.get(name)).split()])


SINGLE_JOINTS = single_joints()
NO_REFERENCES = Limit("references", Outcome.WRITTEN, _zeroed)
