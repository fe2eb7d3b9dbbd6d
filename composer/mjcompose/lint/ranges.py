"""Rules about limits and values that do not fit together."""

from __future__ import annotations

from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.lint.names import other_side, side_of
from mjcompose.lint.rule import ElementEdit, Finding, Found, Subject, rule
from mjcompose.mujoco.addresses import rows_of, span
from mjcompose.mujoco.arrays import BALL, FREE, HINGE, SLIDE
from mjcompose.mujoco.references import ON_JOINTS
from mjcompose.mujoco.unequal import Bound

_LIMITS = {
    "joint": (("range", "limited"), ("actuatorfrcrange", "actuatorfrclimited")),
    "tendon": (("range", "limited"),),
    "actuator": (("ctrlrange", "ctrllimited"), ("forcerange", "forcelimited"), ("actrange", "actlimited")),
}


def _limited(subject: Subject) -> list[tuple[Node, str, str]]:
    """Return elements with the attributes for a range and its switch."""
    actuators = subject.root.iterfind("actuator/*")
    tendons = subject.root.iterfind("tendon/*")
    found = [(each, "joint") for each in subject.each("joint") if each.getparent().tag not in ("fixed", "equality")]  # type: ignore[union-attr]
    found += [(each, "tendon") for each in tendons] + [(each, "actuator") for each in actuators]
    return [(each, *names) for each, kind in found for names in _LIMITS[kind]]


@rule("range-ignored", "A range next to the word that turns its limit off")
def range_ignored(subject: Subject) -> Found:
    for element, attribute, switch in _limited(subject):
        if element.get(attribute) and element.get(switch) == "false":
            message = f"MuJoCo ignores `{attribute}` of {subject.called(element)}, because `{switch}` is false"
            yield Finding(element, message, attribute, help=f"remove `{switch}` or `{attribute}`")


@rule("range-inverted", "A range whose first number is larger than the second")
def range_inverted(subject: Subject) -> Found:
    for element, attribute, _ in _limited(subject):
        numbers = subject.numbers(element, attribute)
        if numbers is not None and len(numbers) == 2 and numbers[0] > numbers[1]:
            low, high = (subject.value(element, attribute) or "").split()
            edit = ElementEdit(((attribute, f"{high} {low}"),)) if element.get(attribute) else None
            message = f"`{attribute}` of {subject.called(element)} runs from {low} down to {high}"
            yield Finding(element, message, attribute, help="write the smaller number first", edit=edit)


_ROUNDING = 1e-4
_FAR_FROM_UNIT = 0.02


@rule("key-out-of-range", "A position, control or activation of a keyframe that is outside its range", in_mujoco=True)
def key_out_of_range(subject: Subject) -> Found:
    from mjcompose.mujoco.index import index, ranged

    model = subject.model
    compiled = index(model, subject.mujoco)
    made = next((each for each in subject.root.iterfind("size") if each.get("nkey")), None)
    for row in range(model.nkey):
        vectors = {"qpos": model.key_qpos[row], "ctrl": model.key_ctrl[row], "act": model.key_act[row]}
        element = subject.node("key", row)
        name = subject.name("key", row)
        if element is None and (made is None or row > len(subject.root.findall("keyframe/key"))):
            continue  # of an attached model, or as empty as the one before
        for each in ranged(compiled, vectors):
            low, high = each.range
            if not each.is_within(-_ROUNDING * max(1.0, abs(high - low))):
                of = subject.name(each.kind, each.number)
                ends = f"{low:.6g} to {high:.6g}"
                message = f"`{each.vector}` of {of} in {name} is {each.value:.6g}, and its range is from {ends}"
                if element is None:
                    yield Finding(made, f"`nkey` makes empty keyframes: {message}", "nkey", help="remove `nkey`")
                else:
                    yield Finding(element, message, each.vector)


@rule(
    "reference-out-of-range",
    "A joint whose reference position is outside its range, in a model without keyframes",
    in_mujoco=True,
)
def reference_out_of_range(subject: Subject) -> Found:
    model = subject.model
    if model.nkey or not subject.is_complete:
        return
    for row in range(model.njnt):
        if not model.jnt_limited[row] or int(model.jnt_type[row]) < SLIDE:
            continue
        at = float(model.qpos0[model.jnt_qposadr[row]])
        low, high = map(float, model.jnt_range[row])
        if not low - _ROUNDING <= at <= high + _ROUNDING:
            unit = "rad" if int(model.jnt_type[row]) == HINGE else "m"
            ends = f"its range is from {low:.4g} to {high:.4g} {unit}"
            message = f"{subject.name('joint', row)} starts at {at:.4g} {unit}, and {ends}; there is no keyframe"
            yield Finding(subject.node("joint", row), message, "range")


@rule(
    "control-misses-range",
    "A position actuator whose controls leave a part of its joint's range out of reach",
    in_mujoco=True,
)
def control_misses_range(subject: Subject) -> Found:
    model = subject.model
    for row, joint, control, gear in position_servos(subject):
        if not (model.actuator_ctrllimited[control] and model.jnt_limited[joint]):
            continue
        low, high = sorted(float(each) / gear for each in model.actuator_ctrlrange[control])
        least, most = map(float, model.jnt_range[joint])
        width = most - least
        common = max(min(high, most) - max(low, least), 0.0)
        if width <= 0 or common >= 0.8 * width:
            continue
        aim = f"the controls of {subject.name('actuator', row)} aim from {low:.4g} to {high:.4g}"
        moves = f"{subject.name('joint', joint)} moves from {least:.4g} to {most:.4g}"
        message = f"{aim}, and {moves}: {1 - common / width:.0%} of its range cannot be reached"
        # MuJoCo 4.0 gives the range of the joint to the control, which a gear multiplies.
        ends = " ".join(f"{each:.6g}" for each in sorted((least * gear, most * gear)))
        help = 'write `inheritrange="1"`' if gear == 1 else f'write `ctrlrange="{ends}"`'
        yield Finding(subject.node("actuator", row), message, "ctrlrange", help=help)


_OF_SIDES = {
    "joint": ("range", "damping", "armature", "frictionloss", "stiffness", "actuatorfrcrange"),
    "actuator": ("ctrlrange", "forcerange", "gear", "kp", "kv", "gainprm", "biasprm"),
}
_MIRRORED = frozenset(("range", "actuatorfrcrange", "ctrlrange", "forcerange"))
_ALIKE = Bound(0.01, floor=0.0)


@rule("sides-differ", "A left joint or actuator with other limits, gains or friction than the right one")
def sides_differ(subject: Subject) -> Found:
    joints = list(subject.each("joint"))
    actuators = [each for each in subject.root.iterfind("actuator/*") if isinstance(each.tag, str)]
    for kind, elements in (("joint", joints), ("actuator", actuators)):
        pairs = _sides(elements)
        for attribute in _OF_SIDES[kind]:
            differing = [pair for pair in pairs if not _is_alike(subject, *pair, attribute)]
            if len(differing) > max(1, len(pairs) // 2):
                continue  # the sides differ on purpose
            for left, right in differing:
                here = subject.value(left, attribute) or "not set"
                there = subject.value(right, attribute) or "not set"
                message = f"`{attribute}` of {subject.called(left)} is {here}, and of `{right.get('name')}` {there}"
                yield Finding(left, message, attribute, help="give both sides the same numbers, if that is a slip")


def _sides(elements: list[Node]) -> list[tuple[Node, Node]]:
    """Return the elements on the left, each with its counterpart on the right."""
    named = {str(each.get("name")): each for each in elements if each.get("name")}
    found = [(each, named.get(other_side(name))) for name, each in named.items() if side_of(name) == "l"]
    return [(left, right) for left, right in found if right is not None and left.tag == right.tag]


def _is_alike(subject: Subject, left: Node, right: Node, attribute: str) -> bool:
    """Return whether two sides have the same numbers, or the numbers of a mirror image."""
    here = subject.numbers(left, attribute)
    there = subject.numbers(right, attribute)
    if here is None or there is None or len(here) != len(there):
        return here is None and there is None
    if attribute == "gear":
        here = list(map(abs, here))
        there = list(map(abs, there))
    candidates = [there, [-each for each in reversed(there)]] if attribute in _MIRRORED else [there]
    return any(all(map(_ALIKE.allows, here, each)) for each in candidates)


class JointServo(NamedTuple):
    """An actuator that moves a hinge or slide to its control: its number, joint, address of its control, and gear."""

    actuator: int
    joint: int
    control: int
    gear: float


def position_servos(subject: Subject) -> list[JointServo]:
    model = subject.model
    mujoco = subject.mujoco
    dynamics = mujoco.mjtDyn
    to_a_position = {int(dynamics.mjDYN_NONE), int(dynamics.mjDYN_FILTER), int(dynamics.mjDYN_FILTEREXACT)}
    found = []
    for row in range(len(model.actuator_gaintype)):
        joint = int(model.actuator_trnid[row, 0])
        gain = float(model.actuator_gainprm[row, 0])
        bias = float(model.actuator_biasprm[row, 1])
        gear = float(model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=row).start, 0])
        if (
            int(model.actuator_trntype[row]) in ON_JOINTS
            and int(model.jnt_type[joint]) >= SLIDE
            and int(model.actuator_dyntype[row]) in to_a_position
            and int(model.actuator_biastype[row]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
            and gain > 0
            and abs(gain + bias) <= 1e-6 * gain
            and gear
            and not float(model.actuator_biasprm[row, 0])
        ):
            found.append(JointServo(row, joint, span(model, "ctrl", row).start, gear))
    return found


@rule("solref-below-timestep", "A time constant in `solref` that is shorter than two time steps, which MuJoCo replaces")
def solref_below_timestep(subject: Subject) -> Found:
    if subject.setting("option/flag", "refsafe") == "disable":
        return
    step = float(subject.setting("option", "timestep") or 0.002)
    for element in subject.root.iter("*"):
        for name in ("solref", "solreflimit", "solreffriction"):
            value = element.get(name)
            first = float(value.split()[0]) if value and value.split() else 0.0
            if 0 < first < 2 * step * (1 - 1e-9):
                message = f"MuJoCo replaces the time constant {first:g} s by {2 * step:g} s, twice the time step"
                yield Finding(element, message, name, help=f"write at least {2 * step:g}")


@rule("quat-not-unit", "A quaternion in a keyframe whose length is not 1", in_mujoco=True)
def quat_not_unit(subject: Subject) -> Found:
    model = subject.model
    offsets = {FREE: 3, BALL: 0}
    types = model.jnt_type.tolist()
    starts = model.jnt_qposadr.tolist()
    quats = [(at, starts[at] + offsets[type]) for at, type in enumerate(types) if type in offsets]
    for element in subject.root.iterfind("keyframe/key"):
        written = [float(word) for word in (element.get("qpos") or "").split()]
        if len(written) == model.nq:
            for joint, start in quats:
                length = sum(each * each for each in written[start : start + 4]) ** 0.5
                if abs(length - 1) > _FAR_FROM_UNIT:
                    name = f"keyframe `{element.get('name')}`" if element.get("name") else "this keyframe"
                    message = f"the quaternion of {subject.name('joint', joint)} in {name} has the length {length:.4g}"
                    yield Finding(element, message, "qpos")
