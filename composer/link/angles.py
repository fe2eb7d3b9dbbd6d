"""Pass: one unit of angle and one Euler sequence for the whole model.

The model is in degrees only if every unit is; otherwise it is in radians. MuJoCo's own arithmetic converts degrees
to radians, so the values stay identical to the bit; the conversion from radians to degrees cannot guarantee that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import cast

from lxml import etree
from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.linking import Linking
from composer.numerics.pose import quat_from_euler
from composer.tree.classes import NESTED, Classes, childclass_of, written
from composer.tree.unit import Unit

_TURNED = etree.XPath("(worldbody | default)//*[@euler or @axisangle]")
_LIMITED = "range"
# Not `fovy` and `cutoff`: MuJoCo 4.0 reads these in degrees under `<compiler angle="radian"/>`, too. Nor the numbers of
# keys, which are always in radians.
_ANGULAR = ("range", "ref", "springref", "springyield")
# A ball has no `ref`: MuJoCo 4.0 starts `<joint type="ball" ref="90"/>` at 1 0 0 0.
_OF_BALLS = ("range", "springyield")


def angles(linking: Linking) -> None:
    """Rewrite each unit that differs from what the model will say.

    The part is in degrees, MuJoCo's default, and the base is not:

    >>> from composer.link.example import after
    >>> part = '<worldbody><body euler="180 0 0"><joint range="0 90"/></body></worldbody>'
    >>> base = '<compiler angle="radian"/>'
    >>> after(angles, part, base)
    part: <worldbody><body euler="3.141592653589793 0 0"><joint range="0 1.5707963267948966"/></body></worldbody>
    """
    unit, sequence = model_angle(linking), linking.base.settings.eulerseq
    for part in linking.units:
        settings = part.settings
        to_radians = settings.angle == "degree" and unit == "radian"
        if to_radians or settings.eulerseq != sequence:
            _orientations(linking, part, to_radians, sequence)
        if to_radians:
            _joints(part)


def model_angle(linking: Linking) -> str:
    return linking.angle


def _orientations(linking: Linking, unit: Unit, to_radians: bool, sequence: str) -> None:
    own = unit.settings.eulerseq
    degrees = unit.settings.angle == "degree"
    for element in cast(list[Node], _TURNED(unit.root)):
        euler = element.get("euler")
        if euler is not None and euler.strip():
            values = numbers.read(euler)
            if element.tag == "replicate":
                _replicate(linking, unit, element, values, sequence, to_radians)
            elif own != sequence:
                radians = [numbers.orientation_radians(v) for v in values] if degrees else values
                del element.attrib["euler"]
                element.set("quat", numbers.text(quat_from_euler(radians, own)))
            elif to_radians:
                element.set("euler", numbers.text(map(numbers.orientation_radians, values)))
        axisangle = element.get("axisangle")
        if to_radians and axisangle is not None and axisangle.strip():
            *axis, angle = axisangle.split()
            turned = numbers.text([numbers.orientation_radians(*numbers.read(angle))])
            element.set("axisangle", " ".join([*axis, turned]))


def _replicate(
    linking: Linking, unit: Unit, element: Node, values: list[float], sequence: str, to_radians: bool
) -> None:
    """Convert the angles of a replicate.

    A replicate has no quat, but a rotation about one axis is the same in any sequence that has the axis.
    """
    own = unit.settings.eulerseq
    # The schema has no `quat` for a `<replicate>`, so that a turn about several axes cannot be written in another
    # sequence: `euler="90 90 0"` is 0.5 0.5 0.5 0.5 in `xyz` and 0.5 0.5 0.5 -0.5 in `XYZ`.
    if to_radians:
        values = [numbers.orientation_radians(value) for value in values]
    if own != sequence:
        moved = in_sequence(values, own, sequence)
        if moved is None:
            linking.sink.error(
                "compiler-setting",
                f"`<replicate>` turns about several axes in the sequence `{own}`, the model reads `{sequence}`",
                linking.span(unit, element),
                help="give each axis a `<replicate>` of its own",
            )
            return
        values = moved
    element.set("euler", numbers.text(values))


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
    """Convert the ranges and references of hinges, and the ranges of balls, to radians wherever they are written.

    A class may give one value to hinges and to slides: then each hinge gets the converted value on itself.
    """
    # MuJoCo 4.0 turns a range only if it limits the joint: `<joint range="-90 90" limited="false"/>` keeps -90 90 in
    # `jnt_range`. One class may serve both kinds: of `<joint range="0 90"/>` a hinge takes 1.5708 and a slide 90.
    classes = unit.classes
    in_classes = {
        str(name)
        for section in unit.root.iterchildren("default")
        for joint in section.iter("joint")
        for name in joint.keys()  # noqa: SIM118 (an element is not a mapping)
    }
    given: dict[tuple[Node, str], list[tuple[Node, bool]]] = {}
    own: list[tuple[Node, str]] = []
    for joint in _joints_of_bodies(unit.root):
        childclass = childclass_of(joint)
        for attribute in _ANGULAR:
            writer: Node | None = joint
            if written(joint, attribute) is None:
                writer = _writer(joint, classes, childclass, attribute) if attribute in in_classes else None
            if writer is None:
                continue
            turns = _is_angle(unit, classes, joint, childclass, attribute)
            if writer is joint:
                if turns:
                    own.append((joint, attribute))
            else:
                given.setdefault((writer, attribute), []).append((joint, turns))
    for flex, body in _flexes(unit.root) if in_classes else ():
        for attribute in _ANGULAR:
            writer = _writer(body, classes, body.get("childclass") or childclass_of(body), attribute)
            if writer is not None:
                given.setdefault((writer, attribute), []).append((flex, False))
    own += _of_classes(given)
    own += [each for each in _in_unused_classes(unit) if each not in given]
    for element, attribute in own:
        _convert(element, attribute, numbers.joint_radians)


def _of_classes(given: Mapping[tuple[Node, str], list[tuple[Node, bool]]]) -> Iterator[tuple[Node, str]]:
    """Yield the angles that classes give to joints: in the class, or on the joints if only some have angles."""
    for (writer, attribute), users in given.items():
        if all(turns for _, turns in users):
            yield writer, attribute
            continue
        for joint, turns in users:
            if turns:
                joint.set(attribute, str(writer.get(attribute)))
                yield joint, attribute


def _in_unused_classes(unit: Unit) -> Iterator[tuple[Node, str]]:
    """Yield the angles of classes that no joint uses yet. A joint that is added later reads them in degrees."""
    for section in unit.root.iterchildren("default"):
        for joint in section.iter("joint"):
            if joint.get("type") != "slide":
                yield from ((joint, attribute) for attribute in _ANGULAR if joint.get(attribute))


def _joints_of_bodies(root: Node) -> Iterator[Node]:
    """Yield the joints of bodies, without those in a `<composite>`, which are templates for joints."""
    for worldbody in root.iterchildren("worldbody"):
        for joint in worldbody.iter("joint"):
            parent = joint.getparent()
            if parent is not None and parent.tag in NESTED:
                yield joint


def _flexes(root: Node) -> Iterator[tuple[Node, Node]]:
    """Yield every flex, and the body whose joint defaults apply to the slide joints of its vertices."""
    for flex in root.iter("flexcomp"):
        body = next(flex.iterancestors("body", "worldbody"), None)
        if body is not None:
            yield flex, body


def _writer(joint: Node, classes: Classes, childclass: str | None, attribute: str) -> Node | None:
    """Return the element of a class that sets the joint's value, or None."""
    inherited = classes.get(str(joint.get("class") or childclass or "") or None).lookup("joint", attribute)
    return inherited[1] if inherited else None


def _is_angle(unit: Unit, classes: Classes, joint: Node, childclass: str | None, attribute: str) -> bool:
    kind = classes.effective(joint, childclass, "type") or "hinge"
    if kind != "hinge" and (kind != "ball" or attribute not in _OF_BALLS):
        return False
    if attribute != _LIMITED:
        return True
    limited = classes.effective(joint, childclass, "limited") or "auto"
    # MuJoCo 4.0 turns only a range that limits: `<joint range="0 90" limited="false"/>` compiles to 0 90.
    if limited != "auto":
        return limited == "true"
    low, high = [*numbers.read(classes.effective(joint, childclass, "range") or ""), 0.0, 0.0][:2]
    return unit.settings.autolimits == "true" and low < high


def _convert(element: Node, attribute: str, turn: Callable[[float], float]) -> None:
    value = element.get(attribute)
    if value and str(value).strip():
        element.set(attribute, numbers.text(turn(number) for number in numbers.read(str(value))))
