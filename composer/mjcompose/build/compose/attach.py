"""Steps: a part of the recipe becomes a part for the linker, and a record of it is kept."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.rotation import IDENTITY_QUAT, Pose, quat_from_axisangle, quat_from_euler
from mjcompose.base.suggest import did_you_mean, exists_note, renaming
from mjcompose.build.checks.unchanged import Unchanged
from mjcompose.build.compose.checks import check_class
from mjcompose.build.compose.elements import ElementBuilder, in_radians, joint_attributes, pose_number
from mjcompose.build.compose.load import PartRequest
from mjcompose.build.plan.plan import IN_PLACE, AttachPart, PartRecord, Plan, arrays_of_draw, of_part
from mjcompose.build.plan.steps import DrawValues, SetDefault, SetSingleton
from mjcompose.language.edit import Edit
from mjcompose.language.form import Element, Single
from mjcompose.link import numbers
from mjcompose.link.bodies import effective_pose
from mjcompose.link.linking import AttachmentPlace, Joint, Linking, Part, Sense
from mjcompose.link.numbers import pose_in_world, read_pose
from mjcompose.link.replicates import copy_poses
from mjcompose.link.world import floats_by_itself
from mjcompose.model.classes import MAIN
from mjcompose.model.cost import scaled_above
from mjcompose.model.files import read_settings
from mjcompose.model.selector import Selector
from mjcompose.model.unit import Unit
from mjcompose.mujoco.attributes import arrays_of
from mjcompose.sources.reference import Source
from mjcompose.text.node import locate


def copy_pose(step: AttachPart, making: ElementBuilder) -> Pose:
    """Return the pose of a copy in the frame of the first one. Each axis is in the frame of the one before it."""
    pose = Pose()
    settings = making.angle_context.at((*step.at, "replicate"))
    for number, axis in zip(step.copy, step.attachment.replicate, strict=True):
        x, y, z = (pose_number(value) for value in axis.offset)
        angles = tuple(in_radians(angle, settings) for angle in axis.euler)
        pose = pose @ copy_poses(axis.count, (x, y, z), angles, sequence=settings.eulerseq)[number]
    return pose


# These three reach every body of the model, of whatever part.
_MASSES = frozenset({"boundmass", "boundinertia", "settotalmass"})
# With these a part has fewer bodies or geoms than its source alone, so that there is nothing to compare.
_RESHAPING = frozenset({"fusestatic", "discardvisual"})
# What `drop` leaves out of a part without making it another: settings, of which a model has one.
_WITHOUT_ELEMENTS = frozenset({"option", "visual", "statistic", "size"})


@dataclass(frozen=True, slots=True)
class UnplacedRecord:
    """The record of a part whose place is still an element of the tree. `content` is None for the world."""

    member: PartRecord
    content: Node | None


def unplaced_records(
    plan: Plan, wanted: Iterable[PartRequest], parts: Iterable[Part], inner: Sequence[list[UnplacedRecord]]
) -> list[UnplacedRecord]:
    """Return the records of a plan: those of its own sources and of nested recipes, in the manifest's order.

    `wanted`, `parts` and `inner`, the records of each request that is a nested recipe, begin with the base.
    """
    found: list[UnplacedRecord] = []
    for each, part, below in zip(wanted, parts, inner, strict=True):
        name = part.path(plan.separator)
        if isinstance(each.model, Plan):
            moved = [_in_outer_recipe(member, name, part, separator=plan.separator, cut=_cut(each)) for member in below]
            found += [_with_own_changes(member, each) for member in moved]
        elif each.model is not None:
            keys = {"merge": "", "prefix": part.prefix, "none": None}[part.keyframes]
            member = PartRecord(
                name, part.prefix, each.model,
                keys=keys, welded=part.weld, is_fixed_in_world=each.is_fixed_in_world,
                obscure=_cut_urdf(each), subtree=each.body,
            )  # fmt: skip
            found.append(_with_own_changes(UnplacedRecord(member, part.content), each))
    return _changed_members(plan, found)


def _with_own_changes(each: UnplacedRecord, wanted: PartRequest) -> UnplacedRecord:
    """Return a member with the changes that the edits of its part, and the elements left out, make."""
    member = with_edits(each.member, wanted.edit)
    dropped = {each.section for each in wanted.drop if not each.leaves_keys}
    if not dropped <= _WITHOUT_ELEMENTS:
        member = replace(member, reduced="the recipe leaves out elements")
    return UnplacedRecord(member, each.content)


def _cut(wanted: PartRequest) -> str | None:
    return None if wanted.body is None else f"only its body `{wanted.body}` was taken"


def _cut_urdf(wanted: PartRequest) -> str | None:
    return _cut(wanted) if isinstance(wanted.model, Source) and wanted.model.format == "urdf" else None


def placed_records(found: Iterable[UnplacedRecord], root: Node) -> tuple[PartRecord, ...]:
    """Return the records with the places of the parts, read from the finished model."""
    settings = read_settings(root)
    degrees, sequence = settings.angle == "degree", settings.eulerseq
    return tuple(_place_members(each, degrees, sequence) for each in found)


def _in_outer_recipe(each: UnplacedRecord, name: str, part: Part, separator: str, cut: str | None) -> UnplacedRecord:
    """Return a member of a nested recipe as a member of the outer recipe."""
    member = each.member
    keys = member.keys
    outer = part.prefix if part.keyframes == "prefix" else ""
    if part.keyframes == "none" or keys is None:
        keys = None
    elif part.keyframes == "prefix":
        keys = outer + keys
    member = replace(
        member,
        part=f"{name}{separator}{member.part}",
        prefix=part.prefix + member.prefix,
        keys=keys,
        replaced_keys=tuple(outer + name for name in member.replaced_keys),
        welded=member.welded or part.weld,
        obscure=member.obscure or cut,
    )
    return UnplacedRecord(member, part.content if each.content is None else each.content)


def _changed_members(plan: Plan, found: list[UnplacedRecord]) -> list[UnplacedRecord]:
    """Return the members with the changes that the recipe's own settings make."""
    for step in plan.steps:
        if isinstance(step, SetDefault):
            owner = "" if step.name == MAIN else _longest(step.name, [each.member.prefix for each in found])
            rows = [(row.tag, name) for row in step.element.children for name in row.attributes]
            arrays = [array for tag, name in rows for array in arrays_of(name, tag)]
            found = [_with_changes(each, arrays) if each.member.prefix == owner else each for each in found]
        elif isinstance(step, SetSingleton) and step.section == "compiler":
            written = step.element.attributes
            if not _MASSES.isdisjoint(written):
                found = [_with_changes(each, arrays_of("mass")) for each in found]
            if "lengthrange" in {child.tag for child in step.element.children}:
                found = [_with_changes(each, arrays_of("lengthrange")) for each in found]
            for name in sorted(_RESHAPING & written.keys()):
                reason = f"the recipe sets `compiler.{name}`, which takes elements away"
                found = [UnplacedRecord(replace(each.member, obscure=reason), each.content) for each in found]
    drawn = [arrays_of_draw(step) for step in plan.steps if isinstance(step, DrawValues) and step.sample]
    if drawn:
        arrays = sorted(set().union(*drawn))
        found = [_with_changes(each, arrays) for each in found]
    written_keys = tuple(step.key.name for step in plan.keyframes)
    found = [
        UnplacedRecord(replace(each.member, replaced_keys=(*each.member.replaced_keys, *written_keys)), each.content)
        for each in found
    ]
    prefixes = {each.member.prefix for each in found}
    for each_edit in (step.edit for step in plan.edits):
        found = [
            UnplacedRecord(with_edits(each.member, [each_edit]), each.content)
            if may_match_part(each_edit.select, each.member.prefix, prefixes)
            else each
            for each in found
        ]
    for check in plan.checks:
        if not isinstance(check, Unchanged):
            continue
        meant = of_part([each.member for each in found], check.part, plan.separator)
        arrays = [array for name in check.excepted for array in arrays_of(name)]
        found = [_with_changes(each, arrays) if each.member in meant else each for each in found]
    return found


def _longest(name: str, prefixes: Iterable[str]) -> str:
    return max((prefix for prefix in prefixes if name.startswith(prefix)), key=len, default="")


def _with_changes(each: UnplacedRecord, arrays: Iterable[str]) -> UnplacedRecord:
    changed = tuple(sorted({*each.member.changed, *arrays}))
    return UnplacedRecord(replace(each.member, changed=changed), each.content)


def _place_members(each: UnplacedRecord, degrees: bool, sequence: str) -> PartRecord:
    pose: Pose | None = IN_PLACE
    node = each.content
    while node is not None and node.tag in ("frame", "replicate"):
        # A replicate has many poses, and no single one.
        known = pose if node.tag == "frame" else None
        pose = None if known is None else read_pose(node, degrees, sequence) @ known
        node = node.getparent()
    if pose is not None and not pose.is_finite:
        pose = None
    if node is None or node.tag != "body":
        return replace(each.member, pose=pose)
    name = node.get("name")
    if not name:
        return replace(each.member, pose=pose, obscure="it is attached to a body without a name")
    return replace(each.member, body=str(name), pose=pose)


SENSE = "sense"
"""The key, and without a name that of the body and the site."""
_MATES = ("site", "body", "frame")


def part_of(step: AttachPart, unit: Unit, making: ElementBuilder) -> Part:
    """Return the part without its joints, which need the unit of angle that the parts agree on."""
    place = _place_of(step, making)
    if any(step.copy):
        offset = read_pose(place.offset, False, "xyz") @ copy_pose(step, making)
        place = _at_key(place, offset, "replicate", step=step, making=making)
    if step.attachment.mate is not None:
        place = _mate(place, step, unit, making=making)
    keyframes = step.attachment.key_policy
    return Part(unit, step.prefix, place, keyframes=keyframes, span=step.span, key=str(step.at[-1]))


def add_joints(step: AttachPart, part: Part, linking: Linking, making: ElementBuilder) -> None:
    """Add the connection between the place and the part: nothing, a mocap body or joints."""
    part.sense = _sense(step, making)
    joint = step.attachment.joint
    if joint is None:
        return
    named = {"name": step.prefix} if step.prefix else {}
    if joint == "none":
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
                _attribute_spans(each, making),
            )
            for each in joint
        )
    else:
        attributes = {**named, **joint_attributes(joint, making)}
        part.joints = (Joint("joint", attributes, _attribute_spans(joint, making)),)


def _sense(step: AttachPart, making: ElementBuilder) -> Sense | None:
    """Return the body, the site and the sensors of `sense`, by their names in the recipe."""
    wanted = step.attachment.sensors
    if wanted is None:
        return None
    start = f"{wanted.name}_" if wanted.name else ""
    return Sense(
        step.prefix + (wanted.name or SENSE),
        tuple((tag, f"{step.prefix}{start}{tag}") for tag in wanted.quantities),
        numbers.text([wanted.cutoff]) if wanted.cutoff else "",
        span=locate(making.document, (*step.at, SENSE)),
    )


def _attribute_spans(joint: Element, making: ElementBuilder) -> dict[str, Span]:
    """Return where the recipe writes the attributes of a joint."""
    return {name: making.span(joint, name) for name in joint.attributes}


def check_joints(step: AttachPart, linking: Linking, making: ElementBuilder) -> None:
    """Report classes of those joints that do not exist, once all classes of the model are known."""
    joint = step.attachment.joint
    elements = joint if isinstance(joint, tuple) else () if joint is None or isinstance(joint, str) else (joint,)
    for element in elements:
        name = element.attributes.get("class")
        if name is not None:
            check_class(linking, making.sink, str(name), span=making.span(element, "class"))


def _place_of(step: AttachPart, making: ElementBuilder) -> AttachmentPlace:
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
        offset["quat"] = _text(quat_from_axisangle([pose_number(each) for each in axis], radians))
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
            return AttachmentPlace(kind, name, offset, span=locate(making.document, (*step.at, kind)), written=written)
    return AttachmentPlace("world", None, offset, written=written)


def _mate(place: AttachmentPlace, step: AttachPart, unit: Unit, making: ElementBuilder) -> AttachmentPlace:
    """Return the place moved so that the part's site, body or frame `mate` lies on it instead of the part's origin."""
    name = step.attachment.mate
    named = [
        element
        for worldbody in unit.root.iterchildren("worldbody")
        for element in worldbody.iter(*_MATES)
        if element.get("name") == name
    ]
    if not named:
        _report_no_mate(step, unit, making)
        return place
    settings = (unit.settings.angle == "degree", unit.settings.eulerseq)
    element = min(named, key=lambda each: _MATES.index(each.tag))
    if (scaled := scaled_above(element)) is not None:
        message = f"`{name}` of `{step.prefix}` is inside a frame that scales: where it is cannot be computed"
        span = locate(making.document, (*step.at, "mate"))
        notes = (Note("the frame", unit.origins.span(scaled, unit.file, "scale")),)
        help = "mate with a site outside the frame"
        making.sink.error("attach-place", message, span, notes=notes, help=help, subjects=(name, step.prefix))
    outer = element.getparent()
    assert outer is not None
    own = effective_pose(element, unit.classes) if element.tag == "site" else element
    mate = pose_in_world(outer, *settings) @ read_pose(own, *settings)
    moved = read_pose(place.offset, False, "xyz") @ mate.inverse()
    return _at_key(place, moved, "mate", step=step, making=making)


def _at_key(
    place: AttachmentPlace, pose: Pose, key: Literal["mate", "replicate"], step: AttachPart, making: ElementBuilder
) -> AttachmentPlace:
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
    return numbers.text(pose_number(value) for value in values)


def _text(values: Iterable[float]) -> str:
    return numbers.text(value + 0.0 for value in values)  # no -0, which an inverse is full of


def _report_no_mate(step: AttachPart, unit: Unit, making: ElementBuilder) -> None:
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
    message = f"`{step.prefix}` has no site, body or frame `{name}` to mate with"
    span = locate(making.document, (*step.at, "mate"))
    notes = [exists_note(tag, names, name) for tag, names in known.items() if names or tag != "frame"]
    help = did_you_mean(name, [each for names in known.values() for each in names], "mate: {}")
    fix = renaming(name, [each for names in known.values() for each in names])
    making.sink.error("attach-place", message, span, notes=notes, help=help, subjects=(name, step.prefix), fix=fix)


_HEAD = re.compile(r"[^*?{\[]*")


def with_edits(member: PartRecord, edits: Iterable[Edit]) -> PartRecord:
    """Return the record with the arrays that edits change in the part, or with the reason why it is not compared."""
    changed, reduced = set(member.changed), member.reduced
    for edit in edits:
        if any(verb.reshapes for verb in edit.verbs.values()):
            reduced = reduced or "the recipe takes away, moves or converts elements"
        changed |= {array for tag, name in _changed_attributes(edit) for array in arrays_of(name, tag)}
    return replace(member, changed=tuple(sorted(changed)), reduced=reduced)


def may_match_part(selector: Selector, prefix: str, prefixes: Collection[str]) -> bool:
    """Return whether a selector can match elements of the part with that prefix, judged by the start of names."""
    if selector.pattern.startswith("/"):
        return True
    found = _HEAD.match(selector.pattern)
    head = found[0] if found is not None else ""
    if head != selector.pattern and prefix.startswith(head):
        return True
    return prefix == max((each for each in prefixes if head.startswith(each)), key=len, default=prefix)


def _changed_attributes(edit: Edit) -> Iterator[tuple[str | None, str]]:
    """Yield the attributes that an edit changes, each with the tag if it is known."""
    tag = None if "/" in edit.select.tag else edit.select.tag
    for verb in edit.verbs.values():
        yield from verb.changes(tag)
