"""Passes: one unit of angle and one Euler sequence, and flexes that keep their place.

The model is in degrees only if every unit is; otherwise it is in radians. MuJoCo's own arithmetic converts degrees to
radians, so the values stay identical to the bit. The conversion from radians to degrees cannot guarantee that.

MuJoCo gives a flex the joint defaults of its body, or the joint defaults of the top class if the flex is in the world;
no frame and no class of its own can change that. So the joint settings for a flex in the world stay in the top class,
and every other class reverts them. If a flex would get other defaults than it has alone, that is an error.

Directly below a body or the world, MuJoCo takes a `quat` as it is, even if its length is not 1; this stretches the
flex. Below a frame, such as the frame around a part, MuJoCo normalizes it. The difference is reported, and is an
error from 0.1 % on.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import TypeAlias, cast

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.base.rotation import normalize
from mjcompose.link import numbers
from mjcompose.link.linking import Flex, Linking
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN, NESTED, Classes, childclass_of, through_frames, written
from mjcompose.tree.grammar import GRAMMAR, to_text
from mjcompose.tree.journal import Why, because
from mjcompose.tree.unit import Unit

_TURNED = etree.XPath("(worldbody | default)//*[@euler or @axisangle]")
# Without `fovy` and `cutoff`, which MuJoCo 4.0 reads in degrees even under `<compiler angle="radian"/>`, and without
# the numbers of keys, which are always in radians.
_ANGULAR = ("range", "ref", "springref", "springyield")
# A ball has no `ref`: MuJoCo 4.0 starts `<joint type="ball" ref="90"/>` at 1 0 0 0.
_OF_BALLS = ("range", "springyield")


def angles(linking: Linking) -> None:
    """Rewrite each unit that differs from the model."""
    unit = linking.angle
    sequence = linking.base.settings.eulerseq
    for part in linking.units:
        settings = part.settings
        to_radians = settings.angle == "degree" and unit == "radian"
        if to_radians or settings.eulerseq != sequence:
            _orientations(linking, part, to_radians, sequence=sequence)
        if to_radians:
            _joints(part)


def _in_degrees(unit: Unit) -> str:
    default = "" if unit.setting_place("angle") else ", MJCF's default"
    return f"{unit.file_name} is in degrees{default}"


def _turned_to_radians(unit: Unit) -> Why:
    words = f"degrees → radians: {_in_degrees(unit)}, the model in radians"
    return because(words, unit.setting_place("angle"))


def _of_another_sequence(unit: Unit) -> Why:
    words = f"{unit.file_name} reads angles in the sequence `{unit.settings.eulerseq}`, the model does not"
    return because(words, unit.setting_place("eulerseq"))


def _orientations(linking: Linking, unit: Unit, to_radians: bool, sequence: str) -> None:
    own = unit.settings.eulerseq
    degrees = unit.settings.angle == "degree"
    radians_why = _turned_to_radians(unit)
    sequence_why = _of_another_sequence(unit)
    for element in cast(list[Node], _TURNED(unit.root)):
        euler = element.get("euler")
        if euler is not None and euler.strip():
            values = numbers.read(euler)
            if element.tag == "replicate":
                _replicate(linking, unit, element, values=values, sequence=sequence, to_radians=to_radians)
            elif own != sequence:
                radians = [numbers.orientation_radians(v) for v in values] if degrees else values
                journal.drop(element, "euler", sequence_why)
                journal.write(element, "quat", numbers.text(numbers.quat_from_euler(radians, own)), sequence_why)
            elif to_radians:
                journal.write(element, "euler", numbers.text(map(numbers.orientation_radians, values)), radians_why)
        axisangle = element.get("axisangle")
        if to_radians and axisangle is not None and axisangle.strip():
            *axis, angle = axisangle.split()
            turned = numbers.text([numbers.orientation_radians(*numbers.exactly(angle, 1))])
            journal.write(element, "axisangle", " ".join([*axis, turned]), radians_why)


def _replicate(
    linking: Linking, unit: Unit, element: Node, values: list[float], sequence: str, to_radians: bool
) -> None:
    """Convert the angles of a replicate, which has no quat: about one axis, a rotation is the same in any sequence."""
    own = unit.settings.eulerseq
    # The schema has no `quat` for a `<replicate>`, so a turn about several axes cannot be written in another sequence:
    # `euler="90 90 0"` is 0.5 0.5 0.5 0.5 in `xyz` and 0.5 0.5 0.5 -0.5 in `XYZ`.
    if to_radians:
        values = [numbers.orientation_radians(value) for value in values]
    if own != sequence:
        moved = in_sequence(values, own, sequence)
        if moved is None:
            message = f"`<replicate>` turns about several axes in the sequence `{own}`, the model reads `{sequence}`"
            help = "give each axis a `<replicate>` of its own"
            linking.sink.error("compiler-setting", message, linking.span(unit, element), help=help)
            return
        values = moved
    why = _turned_to_radians(unit) if own == sequence else _of_another_sequence(unit)
    journal.write(element, "euler", numbers.text(values), why)


def in_sequence(values: Sequence[float], own: str, sequence: str) -> list[float] | None:
    """Convert angles from the sequence `own` to another one. Return None if they turn about several axes.

    >>> in_sequence([20, 0, 0], "xyz", "zyx")
    [0.0, 0.0, 20]
    """
    turning = [at for at, value in enumerate(values) if value]
    letters = sequence.lower()
    if len(turning) > 1 or (turning and own[turning[0]].lower() not in letters):
        return None
    moved = [0.0, 0.0, 0.0]
    for at in turning:
        moved[letters.index(own[at].lower())] = values[at]
    return moved


def _joints(unit: Unit) -> None:
    """Convert ranges and references of hinges, and ranges of balls, to radians; on the joint if a class has slides."""
    # MuJoCo 4.0 turns a range only if it limits the joint: `<joint range="-90 90" limited="false"/>` keeps -90 90 in
    # `jnt_range`. One class may serve both kinds: of `<joint range="0 90"/>` a hinge takes 1.5708 and a slide 90.
    in_classes = {
        str(name)
        for joint in unit.root.iterfind("default//joint")
        for name in joint.keys()  # noqa: SIM118 (an element is not a mapping)
    }
    angles, users = _read_by_joints(unit, in_classes)
    if in_classes:
        _add_flexes(unit, users)
    angles += _settle_classes(unit, users)
    angles += _unused_angles(unit, users)
    why = _turned_to_radians(unit)
    for element, attribute in angles:
        value = str(element.get(attribute) or "")
        if value.strip():
            journal.write(element, attribute, _radians(value), why)


def _radians(text: str) -> str:
    return numbers.text(map(numbers.joint_radians, numbers.read(text)))


_Place: TypeAlias = tuple[Node, str]
"""An element and one of its attributes."""
_Users: TypeAlias = dict[_Place, list[tuple[Node, bool]]]
"""For an attribute of a class, the elements that take it, and whether it is an angle there."""


def _read_by_joints(unit: Unit, in_classes: Collection[str]) -> tuple[list[_Place], _Users]:
    """Return the angles that joints have themselves, and the attributes that they take from classes."""
    classes = unit.classes
    angles: list[_Place] = []
    users: _Users = {}
    for joint in unit.root.iterfind("worldbody//joint"):
        holder = joint.getparent()
        if holder is None or holder.tag not in NESTED:
            continue  # a template in a `<composite>`
        childclass = childclass_of(joint)
        for attribute in _ANGULAR:
            writer: Node | None = None
            if written(joint, attribute) is not None:
                writer = joint
            elif attribute in in_classes:
                writer = _writer(joint, classes, childclass, attribute=attribute)
            if writer is None:
                continue
            is_angle = _is_angle(unit, classes, joint, childclass=childclass, attribute=attribute)
            if writer is not joint:
                users.setdefault((writer, attribute), []).append((joint, is_angle))
            elif is_angle:
                angles.append((joint, attribute))
    return angles, users


def _add_flexes(unit: Unit, users: _Users) -> None:
    """Add the flexes to the users: the joint defaults of a body apply to the slide joints of a flex's vertices."""
    for flex in unit.root.iter("flexcomp"):
        body = next(flex.iterancestors("body", "worldbody"), None)
        if body is None:
            continue
        childclass = body.get("childclass") or childclass_of(body)
        for attribute in _ANGULAR:
            writer = _writer(body, unit.classes, childclass, attribute=attribute)
            if writer is not None:
                users.setdefault((writer, attribute), []).append((flex, False))


def _settle_classes(unit: Unit, users: _Users) -> list[_Place]:
    """Return the angles of classes whose users all have an angle there.

    A class cannot have the angle if other joints have none. Then each joint with an angle gets the value itself.
    """
    angles: list[_Place] = []
    for (writer, attribute), takers in users.items():
        if all(is_angle for _, is_angle in takers):
            angles.append((writer, attribute))
            continue
        words = f"its class gives it to joints that slide too; in radians here, {_in_degrees(unit)}"
        why = because(words, unit.origins.lasting_place(writer, unit.file, attribute))
        text = str(writer.get(attribute))
        for joint, is_angle in takers:
            if is_angle:
                journal.write(joint, attribute, _radians(text) if text.strip() else text, why)
    return angles


def _unused_angles(unit: Unit, users: _Users) -> Iterator[_Place]:
    """Yield the angles of classes that no joint uses yet: a joint that is added later reads them in radians."""
    for joint in unit.root.iterfind("default//joint"):
        if joint.get("type") == "slide":
            continue
        for attribute in _ANGULAR:
            if joint.get(attribute) and (joint, attribute) not in users:
                yield joint, attribute


def _writer(joint: Node, classes: Classes, childclass: str | None, attribute: str) -> Node | None:
    inherited = classes.get(str(joint.get("class") or childclass or "") or None).lookup("joint", attribute)
    return inherited[1] if inherited else None


def _is_angle(unit: Unit, classes: Classes, joint: Node, childclass: str | None, attribute: str) -> bool:
    kind = classes.effective(joint, childclass, "type") or "hinge"
    if kind != "hinge" and (kind != "ball" or attribute not in _OF_BALLS):
        return False
    if attribute != "range":
        return True
    limited = classes.effective(joint, childclass, "limited") or "auto"
    # MuJoCo 4.0 turns only a range that limits: `<joint range="0 90" limited="false"/>` compiles to 0 90.
    if limited != "auto":
        return limited == "true"
    low, high = [*numbers.read(classes.effective(joint, childclass, "range") or ""), 0.0, 0.0][:2]
    return unit.settings.autolimits == "true" and low < high


# Settings that a flex has itself, or that MuJoCo refuses. From a class `c` with `<joint armature="3"/>` MuJoCo 4.0
# takes the armature for the vertices in `<body name="b" childclass="c"><flexcomp …/></body>`, and 0 in
# `<body name="b"><frame childclass="c"><flexcomp …/></frame></body>`.
_NOT_TAKEN = ("type", "axis", "pos", "damping", "springdamper")


def note_flexes(linking: Linking) -> None:
    """Record the flexes in the worldbodies of the units before the units are joined."""
    if not linking.parts:
        return
    for unit, part in [(linking.base, None), *((part.unit, part) for part in linking.parts)]:
        for worldbody in unit.root.iterchildren("worldbody"):
            found = (child for child in through_frames(worldbody) if child.tag == "flexcomp")
            linking.notes.flexes.extend(Flex(flex, unit, part, joint=top_joint(unit)) for flex in found)


def in_world(linking: Linking) -> Iterator[Flex]:
    for flex in linking.notes.flexes:
        part = flex.part
        if part is None or (part.place.kind == "world" and not part.has_body):
            yield flex


_FOR_FLEX = because("MuJoCo takes the joint settings of a flex in the world from the top class alone")
_UNDONE = because("undoes the joint settings of the top class, which are for a flex in the world")


def keep_in_main(linking: Linking, top: Node) -> None:
    """Write the settings that a flex in the world needs into the top class. The classes of the units undo them."""
    kept = next((flex.joint for flex in in_world(linking) if flex.joint), None)
    if kept is None:
        return
    linking.notes.main_joint = dict(kept)
    for wrapped in top.iterchildren("default"):
        joint = next(wrapped.iterchildren("joint"), None)
        if joint is None:
            joint = wrapped.makeelement("joint")
            journal.place(wrapped, joint, 0, _UNDONE)
        for name, value in undo_settings(kept).items():
            if written(joint, name) is None:
                journal.write(joint, name, value, _UNDONE)
    journal.place(top, top.makeelement("joint", linking.notes.main_joint), 0, _FOR_FLEX)


def undo_settings(given: Mapping[str, str]) -> dict[str, str]:
    # As many numbers as are given, for the others are MuJoCo's own.
    undone = {name: _neutral(name).split()[: len(value.split())] for name, value in given.items()}
    return {name: " ".join(values) for name, values in undone.items() if values}


def check_flexes(linking: Linking) -> None:
    """Refuse a flex whose vertices would get other joint defaults in the model than alone."""
    for flex in linking.notes.flexes:
        body = next(flex.element.iterancestors("body"), None)
        given: Mapping[str, str] = linking.notes.main_joint
        level = None
        if body is not None:
            level = linking.base.classes.get(str(body.get("childclass") or childclass_of(body) or MAIN))
            values = {name: level.lookup("joint", name) for name in GRAMMAR.element("default/joint").attributes}
            given = _differing_settings({name: value[0] for name, value in values.items() if value is not None})
        lost = any(name in flex.joint and not _neutral(name) for name in given)
        one, other = ({name: text.split() for name, text in each.items()} for each in (given, flex.joint))
        if lost or one != other:
            called = flex.part.called if flex.part is not None else linking.base.label
            note = "a flex takes the joint defaults of the body around it, or of `main` in the world"
            message = f"takes the joint defaults {_shown(flex.joint)} alone, and here {_shown(given)}"
            _refuse(linking, flex, f"the flex of `{called}` {message}", note=note)
        elif flex.part is not None and "joint" in linking.request.isolated_tags:
            # The recipe sets joint defaults of the base's top class.
            above = [] if level is None else [each.name for each in level.line()]
            if linking.base_class in above:
                place = flex.part.place
                why = f"it is attached to the {place.kind} `{place.name}`"
                what = f"the flex of `{flex.part.called}` would take the joint defaults that the recipe sets for `main`"
                note = "a flex takes the joint defaults of the body around it"
                _refuse(linking, flex, f"{what}: {why}", note=note, subjects=(flex.part.called, place.name))


def top_joint(unit: Unit) -> dict[str, str]:
    given: dict[str, str] = {}
    for joint in unit.root.iterfind("default/joint"):
        given.update({str(name): str(value) for name, value in joint.items() if value.strip()})
    return _differing_settings(given)


def _differing_settings(given: Mapping[str, str]) -> dict[str, str]:
    return {
        name: value
        for name, value in given.items()
        if name not in _NOT_TAKEN and name != "class" and value.split() != _neutral(name).split()
    }


def _neutral(name: str) -> str:
    """Return MuJoCo's default value, or an empty text if it cannot be written."""
    attribute = GRAMMAR.element("default/joint").attributes[name]
    return "" if attribute.default is None else to_text(attribute, attribute.default)


def _refuse(linking: Linking, flex: Flex, message: str, note: str, subjects: Sequence[str | None] = ()) -> None:
    span = linking.span(flex.unit, flex.element)
    help = "put the `<flexcomp>` into a `<body>` of its own"
    linking.sink.error("not-supported", message, span, notes=(Note(note),), help=help, subjects=subjects)


def _shown(joint: Mapping[str, str]) -> str:
    return " ".join(f'`{name}="{value}"`' for name, value in joint.items()) or "of MuJoCo"


_ROUNDING = 1e-9
_TOLERABLE = 1e-3


def flex_turns(linking: Linking) -> None:
    """Report changes that frames make to the flexes in the worldbodies of parts."""
    for flex in linking.notes.flexes:
        parent = flex.element.getparent()
        # In a frame of its own, MuJoCo reads a flex the same way alone.
        if flex.part is None or parent is None or parent.tag != "worldbody":
            continue
        quat = numbers.read(str(flex.element.get("quat") or "1 0 0 0"))
        length = math.hypot(*quat)
        # A first number alone does not turn in MuJoCo 4.0, and does not stretch: `quat="2 0 0 0"` leaves vertices at
        # 0.5 that `quat="0 2 0 0"` moves to 3.5.
        if len(quat) != 4 or not any(quat[1:]) or abs(length - 1) < _ROUNDING:
            continue
        report = linking.sink.error if abs(length - 1) > _TOLERABLE else linking.sink.warning
        w, x, y, z = quat
        why = "MuJoCo stretches it alone, and not below a frame"
        message = f"the flex of `{flex.part.called}` is turned by a `quat` of length {length:.6g}: {why}"
        help = f'write `quat="{numbers.text(normalize((w, x, y, z)))}"`, which only turns'
        report("not-supported", message, linking.span(flex.unit, flex.element, "quat"), help=help)
