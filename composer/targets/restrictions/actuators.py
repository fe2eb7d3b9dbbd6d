"""Limits about actuators: which ones a target reads, and what it makes of gears, gains, forces and armatures."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome
from composer.targets.plain.actuators import simple_actuators
from composer.targets.plain.numbers import text
from composer.targets.restrictions.unread import without_attribute

_SINGLE = ("hinge", "slide")
_GAINS = ("kp", "kv")
_SIMPLE = ("motor", "position", "velocity")
_JOINT = 0  # mjTRN_JOINT


def servos(*tags: str) -> Limit:
    """Return a limit that keeps actuators with these tags that act on a hinge or a slide, and removes the others."""
    return Limit("actuators", Outcome.PARTLY if tags else Outcome.LEFT_OUT, partial(_servos, tags))


def _servos(tags: tuple[str, ...], draft: Draft) -> None:
    simple_actuators(draft.root, any_input=True)
    single = {joint.get("name") for joint in draft.root.iterfind(".//joint") if joint.get("type") in _SINGLE}
    for actuator in list(draft.root.iterfind("actuator/*")):
        if actuator.tag in tags and actuator.get("joint") in single:
            continue
        why = f"it reads {' and '.join(f'`{tag}`' for tag in tags)} of hinges and slides" if tags else ""
        draft.lose("actuators", actuator, why)
        draft.remove(actuator)


def _one_for_each_joint(draft: Draft) -> None:
    """Keep actuators without dynamics that are the only ones of a hinge or a slide."""
    single = {joint.get("name") for joint in draft.root.iterfind(".//joint") if joint.get("type") in _SINGLE}
    actuators = list(draft.root.iterfind("actuator/*"))
    joints = [actuator.get("joint") for actuator in actuators]
    for actuator, joint in zip(actuators, joints, strict=True):
        if joint not in single or joints.count(joint) > 1 or actuator.get("dyntype", "none") != "none":
            draft.lose("actuators", actuator, "it reads one for each hinge or slide, without dynamics")
            draft.remove(actuator)


def _at_joints(draft: Draft) -> None:
    """Multiply each gear into what it changes."""
    for actuator in draft.root.iterfind("actuator/*"):
        gear = _gear(actuator)
        if actuator.get("joint") is None or gear in (0, 1):
            continue
        if actuator.tag not in _SIMPLE:
            draft.lose("gears", actuator, what="`gear`")
            continue
        del actuator.attrib["gear"]
        for name in _GAINS:
            if actuator.get(name):
                actuator.set(name, text(float(str(actuator.get(name))) * gear**2))
        _scale(actuator, "forcerange", gear)
        _scale(actuator, "ctrlrange", gear if actuator.tag == "motor" else 1 / gear)
        draft.lose("gears", actuator, "their gear is in their gains, and controls are at the joint",
                   outcome=Outcome.WRITTEN)  # fmt: skip


def _gear(actuator: Node) -> float:
    return float((actuator.get("gear") or "1").split()[0])


def _scale(element: Node, name: str, by: float) -> None:
    if element.get(name):
        element.set(name, text(sorted(float(each) * by for each in str(element.get(name)).split())))


def _symmetric(draft: Draft) -> None:
    """Widen each range of a force to the same limit on both sides."""
    for actuator in draft.root.iterfind("actuator/*"):
        for name in ("forcerange", "ctrlrange") if actuator.tag == "motor" else ("forcerange",):
            ends = [float(each) for each in (actuator.get(name) or "").split()]
            most = max(map(abs, ends), default=0.0)
            if ends and (ends[0] != -most or ends[1] != most):
                actuator.set(name, text((-most, most)))
                draft.lose("effort", actuator, "it has the same limit on both sides",
                           what=f"the narrower side of `{name}`")  # fmt: skip


def _reflected(draft: Draft) -> None:
    """Leave out the armature of joints without an actuator.

    Drake 1.51 reads the armature of a joint as the inertia of the rotor of its actuator. Of several it takes one.
    """
    driven = {actuator.get("joint") for actuator in draft.root.iterfind("actuator/*")}
    for joint in draft.root.iterfind(".//joint"):
        if joint.get("name") not in driven and float(joint.attrib.pop("armature", "") or 0):
            draft.lose("armature", joint, "it reads that of joints with an actuator", what="armature")


def _carried(draft: Draft) -> None:
    """Write the greatest force of the actuators of a joint as that of the joint, too."""
    for number, joint in draft.of("joint"):
        most = greatest_force(draft.model, number)
        if joint.get("type") in _SINGLE and most is not None and not draft.model.jnt_actgravcomp[number]:
            joint.set("actuatorfrcrange", text((-most, most)))
            joint.set("actuatorfrclimited", "true")


def greatest_force(model: Any, joint: int) -> float | None:
    """Return the greatest force (N) or torque (N·m) at a joint, from its actuators and its own limit; None without."""
    limits = [float(np.abs(model.jnt_actfrcrange[joint]).max())] if model.jnt_actfrclimited[joint] else []
    drives = np.flatnonzero(
        (model.actuator_trntype == _JOINT) & (model.actuator_trnid[:, 0] == joint)
    ).tolist()
    forces = [_greatest(model, each) for each in drives]
    known = [each for each in forces if each is not None]
    if drives and len(known) == len(drives):
        limits.append(sum(known))
    return min(limits, default=None)


def _greatest(model: Any, actuator: int) -> float | None:
    """Return the greatest force of an actuator at its joint: by its range, or of a motor by that of its control."""
    ends = np.array([-np.inf, np.inf])
    if model.actuator_forcelimited[actuator]:
        ends = model.actuator_forcerange[actuator]
    plain = not (
        model.actuator_gaintype[actuator]
        or model.actuator_biastype[actuator]
        or model.actuator_dyntype[actuator]
    )
    if plain and model.actuator_ctrllimited[actuator]:
        ends = np.clip(
            ends, *np.sort(model.actuator_ctrlrange[actuator] * model.actuator_gainprm[actuator][0])
        )
    most = float(np.abs(ends).max()) * abs(float(model.actuator_gear[actuator][0]))
    return most if np.isfinite(most) else None


def _geared(draft: Draft) -> None:
    for actuator in draft.root.iterfind("actuator/*"):
        if actuator.get("joint") and _gear(actuator) != 1:
            draft.lose(
                "gears", actuator, "its solvers other than MuJoCo take the gains as they are", what="`gear`"
            )


ONE_FOR_EACH_JOINT = Limit("actuators", Outcome.PARTLY, _one_for_each_joint)
AT_JOINTS = Limit("gears", Outcome.WRITTEN, _at_joints)
GEARS = Limit("gears", Outcome.PARTLY, _geared)
SYMMETRIC_FORCES = Limit("effort", Outcome.PARTLY, _symmetric)
REFLECTED_ARMATURE = Limit("armature", Outcome.PARTLY, _reflected)
CARRIED_FORCES = Limit("effort", Outcome.WRITTEN, _carried)
NO_SERVO_DAMPING = without_attribute("gains", "actuator/position", "kv", what="`kv`")
NO_ACTUATOR_ARMATURE = without_attribute("armature", "actuator/*", "armature", what="armature")
NO_DELAY = without_attribute("actuators", "actuator/*", "delay", what="`delay`", also=("nsample", "interp"))
NO_ACTUATOR_DAMPING = without_attribute("damping", "actuator/*", "damping", what="damping")
