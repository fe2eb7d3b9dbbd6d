"""Rules about the order of elements and about keyframes."""

from __future__ import annotations

from itertools import pairwise

from mjcompose.lint.ranges import position_servos
from mjcompose.lint.rule import Finding, Found, Subject, rule

_FAR = 0.05
"""How far a control may be from the position of its joint, relative to the joint's range."""


@rule("actuator-order", "Actuators in a different order from their joints", in_mujoco=True)
def actuator_order(subject: Subject) -> Found:
    model = subject.model
    at_joints = (model.actuator_trntype == int(subject.mujoco.mjtTrn.mjTRN_JOINT)).nonzero()[0]
    joints = model.actuator_trnid[at_joints, 0].tolist()
    rows = zip(at_joints.tolist(), joints, strict=True)
    if len(set(joints)) < len(joints) or len(joints) < 2:
        return
    for (before, first), (row, joint) in pairwise(rows):
        if joint < first:
            its = f"its {subject.name('joint', joint)} comes before {subject.name('joint', first)}"
            message = f"{subject.name('actuator', row)} comes after {subject.name('actuator', before)}, and {its}"
            yield Finding(subject.node("actuator", row), message)
            return


@rule("key-does-not-hold", "A keyframe whose controls move the joints away from its pose", in_mujoco=True)
def key_does_not_hold(subject: Subject) -> Found:
    model = subject.model
    servos = position_servos(subject)
    for row, name, data in subject.at_keys():
        element = subject.node("key", row)
        away = []
        geared = False
        if element is None:
            continue
        for actuator, joint, control, gear in servos:
            aim = float(model.key_ctrl[row, control]) / gear
            at = float(data.qpos[model.jnt_qposadr[joint]])
            low, high = map(float, model.jnt_range[joint])
            width = high - low if model.jnt_limited[joint] else 3.14
            if abs(aim - at) > _FAR * width:
                away.append((actuator, joint, aim, at))
                geared = geared or gear != 1
        if away and not model.key_ctrl[row].any() and not element.get("ctrl"):
            moved = f"{len(away)} position actuator{'s' * (len(away) > 1)}"
            message = f"{name} has no `ctrl`: {moved}, such as {subject.name('actuator', away[0][0])}, leave its pose"
            help = f"write the positions of the joints{', times the `gear`,' if geared else ''} as `ctrl`"
            yield Finding(element, message, "qpos", help=help)
            continue
        for actuator, joint, aim, at in away:
            aims = f"in {name} {subject.name('actuator', actuator)} aims at {aim:.4g}"
            yield Finding(element, f"{aims}, and {subject.name('joint', joint)} is at {at:.4g}", "ctrl")


@rule("key-breaks-equality", "A keyframe whose pose breaks an equality constraint", in_mujoco=True)
def key_breaks_equality(subject: Subject) -> Found:
    import numpy as np

    for row, name, data in subject.at_keys():
        element = subject.node("key", row)
        if element is None or not data.ne:
            continue
        rows = data.efc_type[: data.nefc] == int(subject.mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        ids = data.efc_id[: data.nefc][rows]
        apart = np.abs(data.efc_pos[: data.nefc][rows])
        for equality in dict.fromkeys(ids.tolist()):
            distance = float(apart[ids == equality].max())
            if distance > 0.01:
                yield Finding(element, f"{name} breaks {subject.name('equality', equality)} by {distance:.3g}", "qpos")
