"""Passes: a `<flexcomp>` in the world of a unit, with its joint defaults and a `quat` that stretches it.

MuJoCo gives a flex the joint defaults of its body, or those of the top class if the flex is in the world; no frame
and no class of its own can change that. So the joint settings for a flex in the world stay in the top class, and
every other class reverts them. A flex that would get other defaults than it has alone is an error.

Directly below a body or the world, MuJoCo takes a `quat` as it is, even if its length is not 1; this stretches the
flex. Below a frame, such as the frame around a part, MuJoCo normalises it. The difference is reported, and is an
error from 0.1 % on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.grammar import GRAMMAR
from composer.grammar.format import to_text
from composer.link import numbers
from composer.link.linking import Linking
from composer.link.notes import Flex
from composer.link.part import Part
from composer.numerics.pose import normalise
from composer.tree.classes import MAIN, DefaultClass, childclass_of, through_frames, written
from composer.tree.unit import Unit

# What a flex decides itself, or MuJoCo refuses to it. Of a class `c` with `<joint armature="3"/>` MuJoCo 4.0 takes the
# armature for the vertices in `<body name="b" childclass="c"><flexcomp …/></body>`, and 0 in
# `<body name="b"><frame childclass="c"><flexcomp …/></frame></body>`.
_NOT_TAKEN = ("type", "axis", "pos", "damping", "springdamper")


def note_flexes(linking: Linking) -> None:
    """Record the flexes in the worldbodies of the units before the units are joined.

    MuJoCo gives their vertices the joint settings of the top class:

    >>> from composer.link.example import noted
    >>> part = (
    ...     '<default><joint armature="2"/></default>'
    ...     '<worldbody><flexcomp name="f" type="grid" count="2 2 1" spacing="1 1 1"/></worldbody>'
    ... )
    >>> noted(note_flexes, part).notes.flexes[0].joint
    {'armature': '2'}
    """
    if not linking.parts:
        return
    for unit, part in [(linking.base, None), *((part.unit, part) for part in linking.parts)]:
        for worldbody in unit.root.iterchildren("worldbody"):
            found = (child for child in through_frames(worldbody) if child.tag == "flexcomp")
            linking.notes.flexes.extend(Flex(flex, unit, part, top_joint(unit)) for flex in found)


def in_world(linking: Linking) -> Iterator[Flex]:
    """Yield the recorded flexes that are also in the world of the joined model."""
    for flex in linking.notes.flexes:
        part = flex.part
        if part is None or (part.place.kind == "world" and not part.has_body):
            yield flex


def keep_in_main(linking: Linking, top: Node) -> None:
    """Write into the top class what a flex in the world needs. The classes of the units undo it."""
    kept = next((flex.joint for flex in in_world(linking) if flex.joint), None)
    if kept is None:
        return
    linking.notes.main_joint = dict(kept)
    for wrapped in top.iterchildren("default"):
        joint = next(wrapped.iterchildren("joint"), None)
        if joint is None:
            joint = wrapped.makeelement("joint")
            wrapped.insert(0, joint)
        for name, value in taken_back(kept).items():
            if written(joint, name) is None:
                joint.set(name, value)
    top.insert(0, top.makeelement("joint", linking.notes.main_joint))


def taken_back(given: Mapping[str, str]) -> dict[str, str]:
    """Return the joint attributes that undo what the top class sets."""
    # As many numbers as are given, for the others are MuJoCo's own.
    undone = {name: _neutral(name).split()[: len(value.split())] for name, value in given.items()}
    return {name: " ".join(values) for name, values in undone.items() if values}


def check_flexes(linking: Linking) -> None:
    """Refuse a flex whose vertices would get other joint defaults in the model than alone.

    A flex takes the joint defaults of the body around it, which are those of the base here:

    >>> from composer.link.example import after
    >>> part = (
    ...     '<default><joint armature="2"/></default>'
    ...     '<worldbody><flexcomp name="f" type="grid" count="2 2 1" dim="2"/></worldbody>'
    ... )
    >>> base = '<worldbody><body><site name="tool"/></body></worldbody>'
    >>> after(check_flexes, part, base, on="tool")
    error: the flex of `p/` takes the joint defaults `armature="2"` alone, and here of MuJoCo
    """
    for flex in linking.notes.flexes:
        body = next(flex.element.iterancestors("body"), None)
        given = linking.notes.main_joint if body is None else _given_by(linking, body)
        lost = [name for name in given if name in flex.joint and not _neutral(name)]
        if not _same(given, flex.joint) or lost:
            _refuse(linking, flex, given)
        elif flex.part is not None and body is not None and _will_be_set(linking, body):
            _refuse_set(linking, flex.part, flex)


def top_joint(unit: Unit) -> dict[str, str]:
    """Return the joint settings of a unit's top class that apply to its flexes."""
    given: dict[str, str] = {}
    for section in unit.root.iterchildren("default"):
        for joint in section.iterchildren("joint"):
            given.update({str(name): str(value) for name, value in joint.items() if value.strip()})
    return _taken(given)


def _given_by(linking: Linking, body: Node) -> dict[str, str]:
    found = _class_of(linking, body)
    kind = GRAMMAR.element("default/joint")
    values = {each: found.lookup("joint", each) for each in kind.attributes}
    return _taken({each: value[0] for each, value in values.items() if value is not None})


def _will_be_set(linking: Linking, body: Node) -> bool:
    """Return whether the recipe sets joint defaults of the base's top class and the body uses that class."""
    if "joint" not in linking.request.isolated_tags:
        return False
    found: DefaultClass | None = _class_of(linking, body)
    while found is not None and found.name != linking.base_class:
        found = found.parent
    return found is not None


def _class_of(linking: Linking, body: Node) -> DefaultClass:
    return linking.base.classes.get(str(body.get("childclass") or childclass_of(body) or MAIN))


def _taken(given: Mapping[str, str]) -> dict[str, str]:
    return {
        name: value
        for name, value in given.items()
        if name not in _NOT_TAKEN and name != "class" and value.split() != _neutral(name).split()
    }


def _neutral(name: str) -> str:
    """Return MuJoCo's default value, or an empty text if it cannot be written."""
    attribute = GRAMMAR.element("default/joint").attributes[name]
    return "" if attribute.default is None else to_text(attribute, attribute.default)


def _same(one: Mapping[str, str], other: Mapping[str, str]) -> bool:
    return {name: value.split() for name, value in one.items()} == {
        name: value.split() for name, value in other.items()
    }


def _refuse(linking: Linking, flex: Flex, given: Mapping[str, str]) -> None:
    part: Part | None = flex.part
    called = part.called if part is not None else linking.base.label
    linking.sink.error(
        "not-supported",
        f"the flex of `{called}` takes the joint defaults {_shown(flex.joint)} alone, and here {_shown(given)}",
        linking.span(flex.unit, flex.element),
        notes=(Note("a flex takes the joint defaults of the body around it, in the world those of `main`"),),
        help="put the `<flexcomp>` into a `<body>` of its own",
    )


def _refuse_set(linking: Linking, part: Part, flex: Flex) -> None:
    linking.sink.error(
        "not-supported",
        f"the flex of `{part.called}` would take the joint defaults that the recipe sets for `main`: "
        f"it is attached to the {part.place.kind} `{part.place.name}`",
        linking.span(flex.unit, flex.element),
        notes=(Note("a flex takes the joint defaults of the body around it"),),
        help="put the `<flexcomp>` into a `<body>` of its own",
        subjects=(part.called, part.place.name),
    )


def _shown(joint: Mapping[str, str]) -> str:
    return " ".join(f'`{name}="{value}"`' for name, value in joint.items()) or "of MuJoCo"


_ROUNDING = 1e-9
_TOLERABLE = 1e-3


def flex_turns(linking: Linking) -> None:
    """Report changes that frames make to the flexes in the worldbodies of parts.

    A `quat` that a frame would normalise is reported:

    >>> from composer.link.example import after
    >>> part = (
    ...     '<worldbody><flexcomp name="f" type="grid" count="2 2 1" dim="2" quat="0 2 0 0"/></worldbody>'
    ... )
    >>> after(flex_turns, part)
    error: the flex of `p/` is turned by a `quat` of length 2: MuJoCo stretches it alone, and not below a frame
    """
    for flex in linking.notes.flexes:
        parent = flex.element.getparent()
        # In a frame of its own a flex is read the same way alone.
        if flex.part is None or parent is None or parent.tag != "worldbody":
            continue
        quat = numbers.read(str(flex.element.get("quat") or "1 0 0 0"))
        length = math.hypot(*quat)
        # Of a number that stands alone MuJoCo 4.0 makes no turn, and so nothing to stretch: `quat="2 0 0 0"` leaves
        # vertices at 0.5 that `quat="0 2 0 0"` takes to 3.5.
        if len(quat) != 4 or not any(quat[1:]) or abs(length - 1) < _ROUNDING:
            continue
        report = linking.sink.error if abs(length - 1) > _TOLERABLE else linking.sink.warning
        w, x, y, z = quat
        report(
            "not-supported",
            f"the flex of `{flex.part.called}` is turned by a `quat` of length {length:.6g}: MuJoCo stretches it "
            "alone, and not below a frame",
            linking.span(flex.unit, flex.element, "quat"),
            help=f'write `quat="{numbers.text(normalise((w, x, y, z)))}"`, which only turns',
        )
