"""Rules about the order of elements and about keyframes."""

from __future__ import annotations

from itertools import pairwise

from mjcompose.build.lint.ranges import servos
from mjcompose.build.lint.rule import Finding, Found, Subject, rule

_FAR = 0.05
"""How far a control may be from the position of its joint, relative to the joint's range."""


@rule("actuator-order", in_mujoco=True, profiles={"menagerie": "actuators have the order of the joints"})
def actuator_order(subject: Subject) -> Found:
    """Actuators in another order than their joints.

    Programs often take `ctrl` for the actuated part of `qpos`. If the order differs, each joint gets the control of
    another one, and a policy that was trained on one model moves other legs on the next.

    ```xml
    <worldbody> … <joint name="left_hip"/> … <joint name="right_hip"/> … </worldbody>
    <actuator>
      <motor joint="right_hip"/>
      <motor joint="left_hip"/>
    </actuator>
    ```

    Move the actuators, and the numbers of `ctrl` in keyframes with them. In a recipe, `interface` fixes the order.
    """
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
    """A keyframe whose controls move the joints away from its pose.

    A position actuator aims at its control. If the keyframe has no `ctrl`, all controls are 0, and the model leaves the
    pose with full force at the first step.

    ```xml
    <position name="elbow" joint="elbow" kp="100"/>
    …
    <key name="home" qpos="1.57"/>   <!-- aims at 0 -->
    ```

    Write the positions of the joints as `ctrl`. In a recipe, `ctrl: hold` does that.
    """
    model = subject.model
    pairs = servos(subject)
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
    """A keyframe whose pose breaks an equality constraint.

    The constraint pulls the bodies together at the first step with a large force: coupled fingers jump, loops snap
    shut. It is measured in meters for `connect` and `weld`, and in the unit of the joint for `joint`.

    ```xml
    <equality><joint joint1="left_finger" joint2="right_finger"/></equality>
    …
    <key name="open" qpos="0.04 0"/>
    ```

    Write a pose that meets the constraint. In a recipe, `repair: true` of a keyframe moves the dependent joints.
    """
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
