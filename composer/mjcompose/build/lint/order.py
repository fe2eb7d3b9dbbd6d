"""Rules about the order of elements and about keyframes."""

from __future__ import annotations

from itertools import pairwise

from mjcompose.build.lint.ranges import position_servos
from mjcompose.build.lint.rule import Finding, Found, Subject, rule

_FAR = 0.05
"""How far a control may be from the position of its joint, relative to the joint's range."""


@rule("actuator-order", in_mujoco=True)
def actuator_order(subject: Subject) -> Found:
    """Actuators in another order than their joints."""
    model, mujoco = subject.model, subject.mujoco
    rows = [
        (row, int(model.actuator_trnid[row, 0]))
        for row in range(model.nu)
        if int(model.actuator_trntype[row]) == int(mujoco.mjtTrn.mjTRN_JOINT)
    ]
    joints = [joint for _, joint in rows]
    if len(set(joints)) < len(joints) or len(joints) < 2:
        return
    for (before, first), (row, joint) in pairwise(rows):
        if joint < first:
            message = (
                f"{subject.name('actuator', row)} comes after {subject.name('actuator', before)}, and its"
                f" {subject.name('joint', joint)} comes before {subject.name('joint', first)}"
            )
            yield Finding(subject.node("actuator", row), message)
            return


@rule("key-does-not-hold", in_mujoco=True)
def key_does_not_hold(subject: Subject) -> Found:
    """A keyframe whose controls move the joints away from its pose."""
    model = subject.model
    pairs = position_servos(subject)
    for row, name, data in subject.at_keys():
        element = subject.node("key", row)
        if element is None:
            continue
        away = []
        for actuator, joint in pairs:
            aim, at = float(model.key_ctrl[row, actuator]), float(data.actuator_length[actuator])
            low, high = map(float, model.jnt_range[joint])
            width = (high - low if model.jnt_limited[joint] else 3.14) * abs(float(model.actuator_gear[actuator, 0]))
            if abs(aim - at) > _FAR * width:
                away.append((actuator, joint, aim, at))
        if not away:
            continue
        if not model.key_ctrl[row].any() and not element.get("ctrl"):
            moved = f"{len(away)} position actuator{'s' * (len(away) > 1)}"
            message = f"{name} has no `ctrl`: {moved}, such as {subject.name('actuator', away[0][0])}, leave its pose"
            yield Finding(element, message, "qpos", help="write the positions of the joints as `ctrl`")
            continue
        for actuator, joint, aim, at in away:
            message = (
                f"in {name} {subject.name('actuator', actuator)} aims at {aim:.4g}, and"
                f" {subject.name('joint', joint)} is at {at:.4g}"
            )
            yield Finding(element, message, "ctrl")


@rule("key-breaks-equality", in_mujoco=True)
def key_breaks_equality(subject: Subject) -> Found:
    """A keyframe whose pose breaks an equality constraint."""
    import numpy as np

    mujoco = subject.mujoco
    for row, name, data in subject.at_keys():
        element = subject.node("key", row)
        if element is None or not data.ne:
            continue
        broken: dict[int, float] = {}
        kind = int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        for each in np.flatnonzero(data.efc_type[: data.nefc] == kind).tolist():
            equality = int(data.efc_id[each])
            broken[equality] = max(broken.get(equality, 0.0), abs(float(data.efc_pos[each])))
        for equality, distance in broken.items():
            if distance > 0.01:
                message = f"{name} breaks {subject.name('equality', equality)} by {distance:.3g}"
                yield Finding(element, message, "qpos")
