"""Step: turn a part of the recipe into a part for the linker."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Literal

from composer.compose.elements import ElementBuilder, in_radians, joint_attributes, plain
from composer.compose.reference_check import check_class
from composer.compose.replicate import copy_pose
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import did_you_mean, exists_note, renaming
from composer.document.node import locate
from composer.link import numbers
from composer.link.bodies import effective_pose
from composer.link.linking import Linking
from composer.link.part import Joint, Part, Place, Sense
from composer.link.placing import pose_in_world, read_pose
from composer.link.root_rules import floats_by_itself
from composer.numerics.pose import IDENTITY_QUAT, Pose, quat_from_axisangle, quat_from_euler
from composer.plan.plan import AttachPart
from composer.recipe.element import Element, Single
from composer.tree.scaled import scaled_above
from composer.tree.unit import Unit

SENSE = "sense"
"""The key, and without a name that of the body and the site."""
_MATES = ("site", "body", "frame")


def part_of(step: AttachPart, unit: Unit, making: ElementBuilder) -> Part:
    """Return the part without its joints, which need the unit of angle that the parts agree on."""
    place = _place(step, making)
    if any(step.copy):
        offset = read_pose(place.offset, False, "xyz") @ copy_pose(step, making)
        place = _computed(place, offset, "replicate", step=step, making=making)
    if step.attachment.mate is not None:
        place = _mated(place, step, unit, making=making)
    keyframes = step.attachment.keyframes
    return Part(unit, step.prefix, place, keyframes=keyframes, span=step.span, key=str(step.at[-1]))


def add_joints(step: AttachPart, part: Part, linking: Linking, making: ElementBuilder) -> None:
    """Add the connection between the place and the part: nothing, a weld, a mocap body or joints."""
    part.sense = _sense(step, making)
    joint = step.attachment.joint
    if joint is None:
        return
    named = {"name": step.prefix} if step.prefix else {}
    if joint == "weld":
        part.weld = True
    elif joint in ("free", "mocap") and floats_by_itself(part.unit, mocap=joint == "mocap"):
        part.by_itself = True
    elif joint == "mocap":
        part.mocap = True
    elif joint == "free":
        # A `<freejoint>` and not `<joint type="free">`: MuJoCo 4.0 gives the second one the joint defaults, an
        # `armature` of all six for instance.
        part.joints = (Joint("freejoint", named),)
    elif joint == "ball":
        # A `<joint>` takes the joint defaults at its place, meant for other joints. A `<freejoint>` takes none.
        part.joints = (Joint("joint", {**named, "type": "ball", "class": "main"}),)
    elif isinstance(joint, tuple):
        part.joints = tuple(
            Joint(
                "joint",
                {"name": step.prefix + str(each.attributes["name"]), **joint_attributes(each, making)},
                _places(each, making),
            )
            for each in joint
        )
    else:
        attributes = {**named, **joint_attributes(joint, making)}
        part.joints = (Joint("joint", attributes, _places(joint, making)),)


def _sense(step: AttachPart, making: ElementBuilder) -> Sense | None:
    """Return the body, the site and the sensors of `sense`, by their names in the recipe."""
    wanted = step.attachment.sense
    if wanted is None:
        return None
    start = f"{wanted.name}_" if wanted.name else ""
    return Sense(
        step.prefix + (wanted.name or SENSE),
        tuple((tag, f"{step.prefix}{start}{tag}") for tag in wanted.quantities),
        numbers.text([wanted.cutoff]) if wanted.cutoff else "",
        span=locate(making.document, (*step.at, SENSE)),
    )


def _places(joint: Element, making: ElementBuilder) -> dict[str, Span]:
    """Return where the recipe writes the attributes of a joint."""
    return {name: making.span(joint, name) for name in joint.attributes}


def check_joints(step: AttachPart, linking: Linking, making: ElementBuilder) -> None:
    """Report classes of those joints that do not exist, once all classes of the model are known."""
    joint = step.attachment.joint
    elements = (
        joint if isinstance(joint, tuple) else () if joint is None or isinstance(joint, str) else (joint,)
    )
    for element in elements:
        name = element.attributes.get("class")
        if name is not None:
            check_class(linking, making.sink, str(name), span=making.span(element, "class"))


def _place(step: AttachPart, making: ElementBuilder) -> Place:
    attachment = step.attachment
    offset: dict[str, str] = {}
    written: dict[str, Span] = {}

    def note(attribute: str, key: str) -> None:
        written[attribute] = locate(making.document, (*step.at, key))

    if attachment.pos is not None:
        offset["pos"] = _numbers(attachment.pos)
        note("pos", "pos")
    if attachment.quat is not None:
        offset["quat"] = _numbers(attachment.quat)
        note("quat", "quat")
    elif attachment.euler is not None:
        settings = making.angle_context.at((*step.at, "euler"))
        angles = [in_radians(angle, settings) for angle in attachment.euler]
        offset["quat"] = numbers.text(quat_from_euler(angles, settings.eulerseq))
        note("quat", "euler")
    elif attachment.axisangle is not None:
        *axis, angle = attachment.axisangle
        radians = in_radians(angle, making.angle_context.at((*step.at, "axisangle")))
        offset["quat"] = _text(quat_from_axisangle([plain(each) for each in axis], radians))
        note("quat", "axisangle")
    elif attachment.xyaxes is not None:
        offset["xyaxes"] = _numbers(attachment.xyaxes)
        note("xyaxes", "xyaxes")
    elif attachment.zaxis is not None:
        offset["zaxis"] = _numbers(attachment.zaxis)
        note("zaxis", "zaxis")
    for kind in ("site", "body", "frame"):
        name = getattr(attachment, kind)
        if name == "world" and kind == "body":
            break
        if name is not None:
            return Place(kind, name, offset, span=locate(making.document, (*step.at, kind)), written=written)
    return Place("world", None, offset, written=written)


def _mated(place: Place, step: AttachPart, unit: Unit, making: ElementBuilder) -> Place:
    """Return the place moved so that the part's site, body or frame `mate` lies on it instead of the part's origin."""
    name = step.attachment.mate
    named = [
        element
        for worldbody in unit.root.iterchildren("worldbody")
        for element in worldbody.iter(*_MATES)
        if element.get("name") == name
    ]
    if not named:
        _no_mate(step, unit, making)
        return place
    settings = (unit.settings.angle == "degree", unit.settings.eulerseq)
    element = min(named, key=lambda each: _MATES.index(each.tag))
    if (scaled := scaled_above(element)) is not None:
        making.sink.error(
            "attach-place",
            f"`{name}` of `{step.prefix}` is inside a frame that scales: where it is cannot be computed",
            locate(making.document, (*step.at, "mate")),
            notes=(Note("the frame", unit.origins.span(scaled, unit.file, "scale")),),
            help="mate with a site outside the frame",
            subjects=(name, step.prefix),
        )
    outer = element.getparent()
    assert outer is not None
    own = effective_pose(element, unit.classes) if element.tag == "site" else element
    mate = pose_in_world(outer, *settings) @ read_pose(own, *settings)
    moved = read_pose(place.offset, False, "xyz") @ mate.inverse()
    return _computed(place, moved, "mate", step=step, making=making)


def _computed(
    place: Place, pose: Pose, key: Literal["mate", "replicate"], step: AttachPart, making: ElementBuilder
) -> Place:
    """Return the place with the offset of a key of the part."""
    offset = _written(pose)
    span = locate(making.document, (*step.at, key), key=True)
    if not pose.is_finite:
        message = f"`{key}` puts `{step.prefix}` where no finite numbers lead"
        making.sink.error("out-of-range", message, span, help="write finite numbers", subjects=(step.prefix,))
    return replace(place, offset=offset, written=dict.fromkeys(offset, span), computed=key)


def _written(pose: Pose) -> dict[str, str]:
    """Return a pose as the attributes of a frame."""
    turned = {} if pose.quat == IDENTITY_QUAT else {"quat": _text(pose.quat)}
    return {"pos": _text(pose.pos), **turned}


def _numbers(values: Iterable[Single]) -> str:
    return numbers.text(plain(value) for value in values)


def _text(values: Iterable[float]) -> str:
    return numbers.text(value + 0.0 for value in values)  # no -0, which an inverse is full of


def _no_mate(step: AttachPart, unit: Unit, making: ElementBuilder) -> None:
    name = step.attachment.mate or ""
    known = {
        tag: [
            str(each.get("name"))
            for top in unit.root.iterchildren("worldbody")
            for each in top.iter(tag)
            if each.get("name")
        ]
        for tag in _MATES
    }
    making.sink.error(
        "attach-place",
        f"`{step.prefix}` has no site, body or frame `{name}` to mate with",
        locate(making.document, (*step.at, "mate")),
        notes=[exists_note(tag, names, name) for tag, names in known.items() if names or tag != "frame"],
        help=did_you_mean(name, [each for names in known.values() for each in names], "mate: {}"),
        subjects=(name, step.prefix),
        fix=renaming(name, [each for names in known.values() for each in names]),
    )
