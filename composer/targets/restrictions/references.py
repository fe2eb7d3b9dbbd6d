"""Limit of a target without joint references: bodies are placed where their joints are at zero."""

from __future__ import annotations

from typing import Any

import numpy as np
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome
from composer.targets.plain.numbers import text
from composer.targets.poses import Pose, about, back, joined, pose, quat, shifted


def _zeroed(draft: Draft) -> None:
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
                    "references", joint, "its body stands where the joint is at zero, not at its reference"
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


NO_REFERENCES = Limit("references", Outcome.WRITTEN, _zeroed)
