"""Joints: a chain of them connects each body to its parent."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.plain.numbers import text
from composer.targets.poses import Pose, about, joined, pose, shifted
from composer.targets.restrictions.actuators import greatest_force
from composer.targets.urdf.links import massless
from composer.targets.urdf.origin import origin

NO_LIMIT = "1000000"
"""URDF wants a number where MuJoCo has no limit."""
_FREE, _BALL, _SLIDE, _HINGE = range(4)


def hung(draft: Draft, body: int, name: str, parent: str) -> Iterator[Node]:
    """Yield the joints between a body and its parent, and the links between them."""
    model = draft.model
    joints = [(number, node) for number, node in draft.of("joint") if int(model.jnt_bodyid[number]) == body]
    stands = pose(model.body_pos[body], model.body_quat[body])
    if not joints:
        yield fixed(f"{name}_fixed", parent, name, frame=stands)
        return
    last = np.zeros(3)
    for at, (number, node) in enumerate(joints):
        called = str(node.get("name") or f"{name}_joint{at or ''}")
        if int(model.jnt_type[number]) == _FREE:
            yield _joint(called, "floating", parent, child=name, frame=stands)
            return
        anchor = np.asarray(model.jnt_pos[number], dtype=float)
        ends = at == len(joints) - 1 and not anchor.any()
        child = name if ends else f"{name}__{called}"
        frame = joined(stands, shifted(anchor - last), _before_reference(model, number))
        found = _joint(called, _type(model, number), parent, child=child, frame=frame)
        _motion(draft, number, node, joint=found)
        yield found
        if not ends:
            yield massless(child)
        parent, last, stands = child, anchor, shifted((0, 0, 0))
    if last.any():
        yield fixed(f"{name}_fixed", parent, name, frame=shifted(-last))


def fixed(name: str, parent: str, child: str, frame: Pose) -> Node:
    """Return a joint that does not move."""
    return _joint(name, "fixed", parent, child=child, frame=frame)


def _before_reference(model: Any, number: int) -> Pose:
    """Return the pose from the reference of a joint to its zero, at which URDF has the frame."""
    reference = float(model.qpos0[model.jnt_qposadr[number]])
    axis = model.jnt_axis[number]
    return about(axis, -reference) if int(model.jnt_type[number]) == _HINGE else shifted(-reference * axis)


def _type(model: Any, number: int) -> str:
    if int(model.jnt_type[number]) == _SLIDE:
        return "prismatic"
    return "revolute" if model.jnt_limited[number] else "continuous"


def _joint(name: str, kind: str, parent: str, child: str, frame: Pose) -> Node:
    found = etree.Element("joint", name=name, type=kind)
    found.append(origin(frame))
    etree.SubElement(found, "parent", link=parent)
    etree.SubElement(found, "child", link=child)
    return found


def _motion(draft: Draft, number: int, node: Node, joint: Node) -> None:
    model = draft.model
    dof = int(model.jnt_dofadr[number])
    etree.SubElement(joint, "axis", xyz=text(model.jnt_axis[number]))
    most = greatest_force(model, number)
    effort = NO_LIMIT if most is None else text(most)
    limit = etree.SubElement(joint, "limit", effort=effort, velocity=NO_LIMIT)
    if model.jnt_limited[number]:
        low, high = model.jnt_range[number]
        limit.set("lower", text(low))
        limit.set("upper", text(high))
    elif joint.get("type") == "prismatic":
        limit.set("lower", f"-{NO_LIMIT}")
        limit.set("upper", NO_LIMIT)
    etree.SubElement(
        joint, "dynamics", damping=text(model.dof_damping[dof]), friction=text(model.dof_frictionloss[dof])
    )
    if model.dof_armature[dof]:
        draft.lose("armature", node, what="armature")
