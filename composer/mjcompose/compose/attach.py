"""Steps: a part of the recipe becomes a part for the linker, perhaps on an element that the recipe adds."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Any, Literal

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.rotation import IDENTITY_QUAT, Pose, quat_from_axisangle, quat_from_euler
from mjcompose.base.suggest import did_you_mean, exists_note, renaming
from mjcompose.compose.checks import check_class
from mjcompose.compose.effects import note_added
from mjcompose.compose.elements import ElementBuilder, joint_attributes, make_node, pose_number, turned
from mjcompose.compose.load import PartSource
from mjcompose.language.checks.unchanged import Unchanged
from mjcompose.language.edit import Edit
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.language.value import RecipeElement
from mjcompose.link import numbers
from mjcompose.link.additions import declare, hang, holder_of
from mjcompose.link.bodies import effective_pose
from mjcompose.link.inertia import has_mass
from mjcompose.link.linking import (
    AddedElement,
    AttachmentPlace,
    Joint,
    LaterPlace,
    Linking,
    MirroredPart,
    Part,
    PlaceName,
    SensorBody,
)
from mjcompose.link.numbers import pose_in_world, read_pose
from mjcompose.link.replicates import copy_poses
from mjcompose.link.world import floats_by_itself
from mjcompose.mujoco.attributes import arrays_of
from mjcompose.plan.plan import BASE, IN_PLACE, AttachPart, PartRecord, Plan, arrays_of_draw, part_name
from mjcompose.plan.steps import AddElement, DrawValues, SetDefault, SetSingleton, steps_adding
from mjcompose.text.node import locate
from mjcompose.tree.classes import MAIN, own
from mjcompose.tree.cost import all_scaled_above, scaled_above
from mjcompose.tree.edit import unresolved
from mjcompose.tree.files import read_settings
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.pattern import Selector
from mjcompose.tree.unit import Unit

# These three change every body of the model, in every part.
_MASSES = frozenset({"boundmass", "boundinertia", "settotalmass"})
# With these a part has fewer bodies or geoms than its source, so they cannot be compared.
_RESHAPING = frozenset({"fusestatic", "discardvisual"})
# A part without these sections can still be compared.
_WITHOUT_ELEMENTS = frozenset({"option", "visual", "statistic", "size"})


class UnplacedRecord(Struct, frozen=False, eq=False):
    """The record of a part whose place is still an element of the tree. `content` is None for the world."""

    member: PartRecord
    content: Node | None

    def update(self, **changes: Any) -> None:
        self.member = replace(self.member, **changes)

    def add_changed(self, arrays: Iterable[str]) -> None:
        self.update(changed=tuple(sorted({*self.member.changed, *arrays})))

    def add(self, changes: Changes) -> None:
        if changes.reduces and not self.member.reduced:
            self.update(reduced="the recipe removes, moves or converts elements")
        if changes.arrays:
            self.add_changed(changes.arrays)


class Changes(Struct, frozen=False):
    """The arrays that edits change in a part, and whether the part `reduces` to less than its source."""

    arrays: set[str] = field(default_factory=set)
    reduces: bool = False

    @classmethod
    def by(cls, edit: Edit) -> Changes:
        tag = None if "/" in edit.select.tag else edit.select.tag
        changes = (change for verb in edit.verbs.values() for change in verb.changes(tag))
        arrays = {array for kind, name in changes for array in arrays_of(name, kind)}
        return cls(arrays, any(verb.reshapes for verb in edit.verbs.values()))

    def add(self, other: Changes) -> None:
        self.arrays |= other.arrays
        self.reduces |= other.reduces


class ChangesOfParts(Struct, frozen=False):
    """The changes of the parts with these `prefixes`, by the beginnings of the names that edits select."""

    prefixes: Collection[str]
    in_all: Changes = field(default_factory=Changes)
    in_part: dict[str, Changes] = field(default_factory=dict)
    in_parts_from: dict[str, Changes] = field(default_factory=dict)

    def add(self, selector: Selector, changes: Changes) -> None:
        """Add changes of the elements that a selector may match, by the start of their names."""
        if selector.pattern.startswith("/"):
            self.in_all.add(changes)
            return
        head = re.split(r"[*?{\[]", selector.pattern, maxsplit=1)[0]
        if head != selector.pattern:
            self.in_parts_from.setdefault(head, Changes()).add(changes)
        part = next((start for start in _starts(head) if start in self.prefixes), None)
        (self.in_all if part is None else self.in_part.setdefault(part, Changes())).add(changes)

    def of_class(self, name: str) -> Changes:
        """Return the changes of the part that a default class belongs to, to add to them."""
        prefix = "" if name == MAIN else next((start for start in _starts(name) if start in self.prefixes), "")
        return self.in_part.setdefault(prefix, Changes())

    def of(self, prefix: str) -> Changes:
        """Return the changes of the part with that prefix."""
        found = Changes()
        found.add(self.in_all)
        found.add(self.in_part.get(prefix, Changes()))
        for start in _starts(prefix):
            found.add(self.in_parts_from.get(start, Changes()))
        return found


def _starts(text: str) -> Iterator[str]:
    """Yield the beginnings of a text, the longest first."""
    return (text[:length] for length in range(len(text), -1, -1))


_OF_RECIPES = "it attaches recipes, which MuJoCo does not read"


def unplaced_records(
    plan: Plan, sources: Iterable[PartSource], linking: Linking, inner: Sequence[list[UnplacedRecord]]
) -> list[UnplacedRecord]:
    """Return the records of the sources of a plan and of nested recipes, `inner`, in the manifest's order."""
    records: list[UnplacedRecord] = []
    parts = [Part(linking.base, "", keyframes=plan.base_keys, key=BASE), *linking.parts]
    for source, part, below in zip(sources, parts, inner, strict=True):
        attachment = linking.attachments.get(part)
        content = None if attachment is None else attachment.content
        name = part.path(plan.separator)
        model = source.model
        cut = None if source.body is None else f"only its body `{source.body}` was taken"
        own: list[UnplacedRecord] = []
        if isinstance(model, Plan):
            own = [_in_outer_recipe(record, name, part, content, plan.separator, cut=cut) for record in below]
        elif model is not None:
            mirrored = source.mirror is not None and source.mirror.keys
            keys = None if mirrored else {"merge": "", "prefix": part.prefix, "none": None}[part.keyframes]
            member = PartRecord(
                name,
                part.prefix,
                model,
                keys=keys,
                welded=part.weld,
                is_fixed_in_world=source.is_fixed_in_world,
                obscure=cut if model.format == "urdf" else _OF_RECIPES if source.attaches_recipes else None,
                subtree=source.body,
            )
            own = [UnplacedRecord(member, content)]
        dropped = {entry.section for entry in source.drop if not entry.leaves_keys}
        for record in own:
            for edit in source.edit:
                record.add(Changes.by(edit))
            if not dropped <= _WITHOUT_ELEMENTS:
                record.update(reduced="the recipe leaves out elements")
        records += own
    _note_changes(plan, records)
    return records


def placed_records(records: Iterable[UnplacedRecord], root: Node) -> tuple[PartRecord, ...]:
    """Return the records with the places of the parts, read from the finished model."""
    settings = read_settings(root)
    return tuple(_placed(record, settings.angle == "degree", settings.eulerseq) for record in records)


def _in_outer_recipe(
    record: UnplacedRecord, name: str, part: Part, content: Node | None, separator: str, *, cut: str | None
) -> UnplacedRecord:
    """Return the record of a part of a nested recipe as a record of the outer recipe."""
    member = record.member
    outer = part.prefix if part.keyframes == "prefix" else ""
    member = replace(
        member,
        part=f"{name}{separator}{member.part}",
        prefix=part.prefix + member.prefix,
        keys=None if part.keyframes == "none" or member.keys is None else outer + member.keys,
        replaced_keys=tuple(outer + name for name in member.replaced_keys),
        welded=member.welded or part.weld,
        obscure=member.obscure or cut,
    )
    return UnplacedRecord(member, content if record.content is None else record.content)


def _note_changes(plan: Plan, records: list[UnplacedRecord]) -> None:
    """Note in the records the changes that the recipe's own settings make."""
    changes = _changes_by(plan, {record.member.prefix for record in records})
    _note_reshaping(plan, records)
    written_keys = tuple(step.key.name for step in plan.keyframes)
    for record in records:
        record.update(replaced_keys=(*record.member.replaced_keys, *written_keys))
        record.add(changes.of(record.member.prefix))
    _note_excepted(plan, records)


def _changes_by(plan: Plan, prefixes: Collection[str]) -> ChangesOfParts:
    """Return the changes that the default classes, the compiler, the draws and the edits of a plan make."""
    changes = ChangesOfParts(prefixes)
    for step in plan.steps:
        if isinstance(step, SetDefault):
            changes.of_class(step.name).arrays.update(_arrays_of_default(step))
        elif isinstance(step, SetSingleton) and step.section == "compiler":
            changes.in_all.arrays.update(_arrays_of_compiler(step))
        elif isinstance(step, DrawValues) and step.sample:
            changes.in_all.arrays.update(arrays_of_draw(step))
    for step in plan.edits:
        changes.add(step.edit.select, Changes.by(step.edit))
    return changes


def _arrays_of_default(step: SetDefault) -> Iterator[str]:
    for row in step.element.children:
        for name in row.attributes:
            yield from arrays_of(name, row.tag)


def _arrays_of_compiler(step: SetSingleton) -> Iterator[str]:
    if not _MASSES.isdisjoint(step.element.attributes):
        yield from arrays_of("mass")
    if any(child.tag == "lengthrange" for child in step.element.children):
        yield from arrays_of("lengthrange")


def _note_reshaping(plan: Plan, records: Iterable[UnplacedRecord]) -> None:
    """Note the settings of the compiler that remove elements of every part."""
    for step in plan.steps:
        if not isinstance(step, SetSingleton) or step.section != "compiler":
            continue
        for name in sorted(_RESHAPING & step.element.attributes.keys()):
            for record in records:
                record.update(obscure=f"the recipe sets `compiler.{name}`, which removes elements")


def _note_excepted(plan: Plan, records: Iterable[UnplacedRecord]) -> None:
    """Note the arrays that the checks `unchanged` of the recipe except."""
    checks = [check for check in plan.checks if isinstance(check, Unchanged) and check.excepted]
    if not checks:
        return
    by_part = _by_part(records, plan.separator)
    for check in checks:
        arrays = {array for name in check.excepted for array in arrays_of(name)}
        checked_records = records if check.part is None else by_part.get(check.part, [])
        for record in checked_records:
            record.add_changed(arrays)


def _by_part(records: Iterable[UnplacedRecord], separator: str) -> dict[str, list[UnplacedRecord]]:
    """Return the records by the part, and by the nested recipes around it."""
    found: dict[str, list[UnplacedRecord]] = {}
    for record in records:
        part = record.member.part
        outer = [part[: end.start()] for end in re.finditer(re.escape(separator), part)]
        for name in dict.fromkeys([*outer, part]):
            found.setdefault(name, []).append(record)
    return found


def _placed(record: UnplacedRecord, degrees: bool, sequence: str) -> PartRecord:
    pose: Pose | None = IN_PLACE
    node = record.content
    while node is not None and node.tag in ("frame", "replicate"):
        # A replicate has many poses.
        pose = None if pose is None or node.tag != "frame" else read_pose(node, degrees, sequence) @ pose
        node = node.getparent()
    member = replace(record.member, pose=pose if pose is not None and pose.is_finite else None)
    if node is None or node.tag != "body":
        return member
    if name := node.get("name"):
        return replace(member, body=str(name))
    return replace(member, obscure="it is attached to a body without a name")


SENSE = "sense"
"""The key in the recipe, and the default name of the body and the site."""
_MATES = ("site", "body", "frame")


def parts_of(plan: Plan, units: Sequence[Unit], making: ElementBuilder) -> list[Part]:
    """Return the parts of a plan. A part that mirrors another one has its place, unless it has its own."""
    numbers_by_name = {part_name(step, plan.separator): number for number, step in enumerate(plan.parts)}
    places = [_place_with_offset(step, unit, making) for step, unit in zip(plan.parts, units, strict=True)]
    parts: list[Part] = []
    for step, unit, own_place in zip(plan.parts, units, places, strict=True):
        place = own_place
        mirrored: MirroredPart | None = None
        mirror = step.attachment.mirror
        original = None if mirror is None else numbers_by_name.get(mirror.of)
        if mirror is not None and original is not None:
            mirrored = MirroredPart(units[original], mirror.axes)
            written = dict.fromkeys(("pos", "quat"), locate(plan.document, (*step.at, "mirror"), key=True))
            host = own_place if step.attachment.place[1] else places[original]
            place = replace(host, offset={}, written=written, computed="mirror")
        parts.append(_part_of(step, unit, place, mirrored, making))
    return parts


def _part_of(
    step: AttachPart, unit: Unit, place: AttachmentPlace, mirrored: MirroredPart | None, making: ElementBuilder
) -> Part:
    """Return the part with the connection to its place: nothing, a mocap body or joints."""
    by_itself = _floats_by_itself(step, unit)
    joint = step.attachment.joint
    return Part(
        unit,
        step.prefix,
        place,
        mirrored=mirrored,
        keyframes=step.attachment.key_policy,
        joints=() if by_itself else _joints(step, making),
        weld=step.floats or joint == "none",
        mocap=joint == "mocap" and not by_itself and not step.floats,
        sense=None if step.floats else _sense(step, making),
        by_itself=by_itself,
        span=step.span,
        key=str(step.at[-1]),
    )


def _place_with_offset(step: AttachPart, unit: Unit, making: ElementBuilder) -> AttachmentPlace:
    """Return the place of a part, where its copy, its mate and its scattering move it."""
    place = _place_of(step, making)
    if any(step.copy) and step.attachment.scatter is None:
        # Each axis is in the frame of the previous axis.
        pose = read_pose(place.offset, False, "xyz")
        settings = making.angle_context.at((*step.at, "replicate"))
        for number, axis in zip(step.copy, step.attachment.replicate, strict=True):
            x, y, z = (pose_number(value) for value in axis.offset)
            angles = tuple(turned(angle, settings) for angle in axis.euler)
            pose = pose @ copy_poses(axis.count, (x, y, z), angles, sequence=settings.eulerseq)[number]
        place = _at_key(place, pose, "replicate", step=step, making=making)
    if step.attachment.mate is not None:
        place = _mate(place, step, unit, making=making)
    if step.moved is not None:
        pose = (read_pose(place.offset, False, "xyz") @ step.moved).rounded()
        place = _at_key(place, pose, "replicate", step=step, making=making)
    return place


def _floats_by_itself(step: AttachPart, unit: Unit) -> bool:
    """Return whether the part has the free joint of the recipe itself, or is a mocap body."""
    joint = step.attachment.joint
    if step.floats or joint not in ("free", "mocap"):
        return False
    return floats_by_itself(unit, mocap=joint == "mocap")


def _joints(step: AttachPart, making: ElementBuilder) -> tuple[Joint, ...]:
    """Return the joints between the place and the part."""
    joint = step.attachment.joint
    named = {"name": step.prefix} if step.prefix else {}
    if step.floats or joint == "free":
        # MuJoCo 4.0 gives a `<joint type="free">` the joint defaults, such as an `armature`, but not a `<freejoint>`.
        return (Joint("freejoint", named),)
    if joint == "ball":
        # With the class `main`, it has none of the joint defaults of its place, which are for other joints.
        return (Joint("joint", {**named, "type": "ball", "class": "main"}),)
    if isinstance(joint, RecipeElement):
        return (_written_joint(joint, named, making),)
    if isinstance(joint, tuple):
        names = [{"name": step.prefix + str(element.attributes["name"])} for element in joint]
        return tuple(_written_joint(element, name, making) for element, name in zip(joint, names, strict=True))
    return ()


def _written_joint(element: RecipeElement, named: Mapping[str, str], making: ElementBuilder) -> Joint:
    """Return a joint that the recipe writes, with the places of its attributes."""
    spans = {name: making.span(element, name) for name in element.attributes}
    return Joint("joint", {**named, **joint_attributes(element, making)}, spans)


def _sense(step: AttachPart, making: ElementBuilder) -> SensorBody | None:
    """Return the body, the site and the sensors of `sense`, by their names in the recipe."""
    if (wanted := step.attachment.sensors) is None:
        return None
    start = f"{wanted.name}_" if wanted.name else ""
    return SensorBody(
        step.prefix + (wanted.name or SENSE),
        tuple((tag, f"{step.prefix}{start}{tag}") for tag in wanted.quantities),
        numbers.text([wanted.cutoff]) if wanted.cutoff else "",
        span=locate(making.document, (*step.at, SENSE)),
    )


def check_joints(step: AttachPart, linking: Linking, making: ElementBuilder) -> None:
    """Report classes of the joints that do not exist, once all classes of the model are known."""
    joint = step.attachment.joint
    joints = joint if isinstance(joint, tuple) else (joint,)
    for element in joints:
        if isinstance(element, RecipeElement) and (name := element.attributes.get("class")) is not None:
            check_class(linking, making.sink, str(name), span=making.span(element, "class"))


def _place_of(step: AttachPart, making: ElementBuilder) -> AttachmentPlace:
    attachment = step.attachment
    offset: dict[str, str] = {}
    written: dict[str, Span] = {}
    for key in ("pos", *ORIENTATIONS):
        if (values := getattr(attachment, key)) is None:
            continue
        attribute = key
        settings = making.angle_context.at((*step.at, key))
        if key == "euler":
            angles = [turned(angle, settings) for angle in values]
            attribute = "quat"
            text = numbers.text(quat_from_euler(angles, settings.eulerseq))
        elif key == "axisangle":
            *axis, angle = values
            quat = quat_from_axisangle([pose_number(number) for number in axis], turned(angle, settings))
            attribute = "quat"
            text = _text(quat)
        else:
            text = numbers.text(map(pose_number, values))
        offset[attribute] = text
        written[attribute] = locate(making.document, (*step.at, key))
    for kind in ("site", "body", "frame"):
        name = getattr(attachment, kind)
        if name == "world" and kind == "body":
            break
        if name is not None:
            return AttachmentPlace(kind, name, offset, span=locate(making.document, (*step.at, kind)), written=written)
    return AttachmentPlace("world", None, offset, written=written)


def _mate(place: AttachmentPlace, step: AttachPart, unit: Unit, making: ElementBuilder) -> AttachmentPlace:
    """Return the place moved so that the part's site, body or frame `mate` lies on it instead of the part's origin."""
    name = step.attachment.mate or ""
    inside = [each for world in unit.root.iterchildren("worldbody") for each in world.iter(*_MATES) if each.get("name")]
    known = {tag: {str(each.get("name")): each for each in inside if each.tag == tag} for tag in _MATES}
    if (element := next((named[name] for named in known.values() if name in named), None)) is None:
        _report_no_mate(step, known, making)
        return place
    settings = (unit.settings.angle == "degree", unit.settings.eulerseq)
    if (scaled := scaled_above(element)) is not None:
        message = f"`{name}` of `{step.prefix}` is inside a frame that scales: its position cannot be computed"
        span = locate(making.document, (*step.at, "mate"))
        notes = (Note("the frame", unit.origins.span(scaled, unit.file, "scale")),)
        help = "mate with a site outside the frame"
        making.sink.error("attach-place", message, span, notes=notes, help=help, subjects=(name, step.prefix))
    outer = element.getparent()
    assert outer is not None
    own = effective_pose(element, unit.classes) if element.tag == "site" else element
    mate = pose_in_world(outer, *settings) @ read_pose(own, *settings)
    return _at_key(place, read_pose(place.offset, False, "xyz") @ mate.inverse(), "mate", step=step, making=making)


def _at_key(
    place: AttachmentPlace, pose: Pose, key: Literal["mate", "replicate"], step: AttachPart, making: ElementBuilder
) -> AttachmentPlace:
    """Return the place with the offset of a key of the part."""
    offset = {"pos": _text(pose.pos)}
    if pose.quat != IDENTITY_QUAT:
        offset["quat"] = _text(pose.quat)
    span = locate(making.document, (*step.at, key), key=True)
    if not pose.is_finite:
        message = f"`{key}` puts `{step.prefix}` at a position that is not finite"
        making.sink.error("out-of-range", message, span, help="write finite numbers", subjects=(step.prefix,))
    return replace(place, offset=offset, written=dict.fromkeys(offset, span), computed=key)


def _text(values: Iterable[float]) -> str:
    return numbers.text(value + 0.0 for value in values)  # no -0, which an inverse is full of


def _report_no_mate(step: AttachPart, known: Mapping[str, Collection[str]], making: ElementBuilder) -> None:
    name = step.attachment.mate or ""
    all_names = [each for names in known.values() for each in names]
    message = f"`{step.prefix}` has no site, body or frame `{name}` to mate with"
    span = locate(making.document, (*step.at, "mate"))
    notes = [exists_note(tag, names, name) for tag, names in known.items() if names or tag != "frame"]
    help = did_you_mean(name, all_names, "mate: {}")
    fix = renaming(name, all_names)
    making.sink.error("attach-place", message, span, notes=notes, help=help, subjects=(name, step.prefix), fix=fix)


def add_element(step: AddElement, linking: Linking, making: ElementBuilder) -> None:
    """Append the element; in the world it takes the base's top class, as if it were written in the base."""
    hang_up(step, _added(step, making), linking, making)


def _added(step: AddElement, making: ElementBuilder, places: Iterable[PlaceName] = ()) -> AddedElement:
    """Make the element of a step, which is not in the model yet."""
    kind = GRAMMAR.element("worldbody" if step.to_kind == "world" else step.to_kind)
    node = make_node(step.element, kind.children.get(step.element.tag, kind), making)
    making.register(node, "worldbody")
    return AddedElement(node, (step.to_kind, step.to), tuple(places), step)


def hang_up(step: AddElement, addition: AddedElement, linking: Linking, making: ElementBuilder) -> None:
    """Append the element of a step, and report a target that does not exist."""
    holder = holder_of(linking, addition)
    if holder is None:
        _report_no_target(step, linking, making)
        declare(linking, addition.node)  # so that references to its names are not a second fault
        return
    hang(linking, addition, holder)
    check_hung(step, addition.node, linking, making)


def check_hung(step: AddElement, node: Node, linking: Linking, making: ElementBuilder) -> None:
    """Report an element that is scaled or adds no mass where it is now."""
    holder = node.getparent()
    assert holder is not None
    _check_scale(step, holder, linking, making=making)
    written = _written_geoms(step, node, making)
    _check_mass(step, node, written, linking, making=making)
    body = next((each for each in (holder, *holder.iterancestors()) if each.tag == "body"), None)
    if body not in linking.notes.inertia_written:  # that is reported already
        note_added(written, making.span_of, making.origins)


def _written_geoms(step: AddElement, node: Node, making: ElementBuilder) -> list[Node]:
    """Return the geoms that a step adds: parts and other steps may already have put theirs into its element."""
    at = step.element.at
    elements = ((geom, making.made.get(geom)) for geom in node.iter("geom"))
    return [geom for geom, element in elements if element is not None and element.at[: len(at)] == at]


def _check_scale(step: AddElement, holder: Node, linking: Linking, making: ElementBuilder) -> None:
    """Report an element that a frame of a source would scale: the recipe writes meters and kilograms."""
    base = linking.base
    for frame in all_scaled_above(holder):
        if isinstance(base.origins.owner(frame, base.file), str):
            message = f"`{step.to}` is inside a frame that scales: the element would have another size and mass"
            span = linking.span(base, frame, "scale" if frame.get("scale") else "massscale")
            help = "add it outside the frame, or write the frame without scale"
            notes = (Note("the frame", span),)
            making.sink.error("not-supported", message, step.to_span, notes=notes, help=help, subjects=(step.to,))
            return


def _check_mass(
    step: AddElement, node: Node, written: Collection[Node], linking: Linking, making: ElementBuilder
) -> None:
    """Report a geom that adds no mass, but would if the inertia rules of its model were not written out."""
    body: Node | None = node.getparent()
    while body is not None and body.tag in ("frame", "replicate"):
        body = body.getparent()
    # An inertial wins over geoms, even over geoms that are added later.
    if body not in linking.notes.inertia_written:
        return
    geoms = [node] if node.tag == "geom" else own(node, "geom") if node.tag in ("frame", "replicate") else []
    if any(geom in written and has_mass(geom, linking.base.classes) for geom in geoms):
        message = f"the element adds no mass to `{step.to}`: the compiler settings of its model give the inertia"
        help = "put it into a `body` of its own, or write `mass: 0`"
        making.sink.warning("compiler-setting", message, step.span, help=help)


def _report_no_target(step: AddElement, linking: Linking, making: ElementBuilder) -> None:
    written = "to: {frame: {}}" if step.to_kind == "frame" else "to: {}"
    help: str | None = None
    later = linking.later_places.get((step.to_kind, step.to))
    if later is not None:
        message = f"the {step.to_kind} `{step.to}` to add to does not exist yet: a later entry adds it"
        notes = (Note("it is added here", later.span),)
        help = "put that entry above this one"
        making.sink.error("unknown-name", message, step.to_span, notes=notes, help=help, subjects=(step.to,))
        return
    kinds = linking.names.kinds_of(step.to)
    site = linking.names.find("site", step.to)
    holder = site.getparent() if site is not None else None
    if step.to_kind == "body" and "frame" in kinds:
        help = f"`{step.to}` is a frame: write `to: {{frame: {step.to}}}`"
    elif step.to_kind == "frame" and "body" in kinds:
        help = f"`{step.to}` is a body: write `to: {step.to}`"
    elif holder is not None and holder.tag == "body" and holder.get("name"):
        help = f"`{step.to}` is a site: write `to: {holder.get('name')}`, the body that contains it"
    making.sink.add(
        unresolved(linking, step.to_kind, step.to, span=step.to_span, written=written, purpose=" to add to", help=help)
    )


def later_places(plan: Plan) -> dict[PlaceName, LaterPlace]:
    """Return the places that a plan adds, each with the element that it is added to."""
    return {
        name: LaterPlace((place.step.to_kind, place.step.to), place.span) for name, place in plan.added_places.items()
    }


def early_additions(plan: Plan, parts: Iterable[Part], making: ElementBuilder) -> dict[int, AddedElement]:
    """Make the elements with the places that parts may wait for, by the identities of their steps.

    Each comes after the elements that it is added to. The keys are identities, since comparing two steps compares
    everything in them.
    """
    places = plan.added_places
    steps: dict[int, AddElement] = {}
    for part in parts:
        chain = steps_adding(places, part.place.kind, str(part.place.name))
        steps.update((id(step), step) for step in chain if id(step) not in steps)
    names: dict[int, list[PlaceName]] = {}
    for name_of_place, place in places.items():
        names.setdefault(id(place.step), []).append(name_of_place)
    return {key: _added(step, making, names[key]) for key, step in steps.items()}
