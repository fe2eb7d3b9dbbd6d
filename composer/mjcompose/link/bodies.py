"""Pass: move the bodies of each part to the part's place, inside a frame with the part's pose and default class."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import partial
from heapq import heappop, heappush

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.suggest import closest, exists_note, renaming
from mjcompose.link import numbers
from mjcompose.link.additions import BRINGS, hang, holder_of, later_names, outermost_target, waiting, world_of
from mjcompose.link.angles import undo_settings
from mjcompose.link.expansion import names_of_copies
from mjcompose.link.inertia import has_mass
from mjcompose.link.key_layout import JOINTS, joint_type
from mjcompose.link.linking import AttachedPart, Joint, Linking, Part, SensorBody
from mjcompose.link.numbers import pose_in_world, read_pose
from mjcompose.link.replicates import original_of
from mjcompose.link.settings import is_leaf
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN, ORIENTATIONS, Classes, childclass_of, default_tag, own, through_frames
from mjcompose.tree.cost import scaled_above
from mjcompose.tree.edit import attached_notes
from mjcompose.tree.journal import Because, because, explained
from mjcompose.tree.names import word
from mjcompose.tree.parse import above

_PLACES = ("site", "body", "frame")
_GIVEN = ("pos", *ORIENTATIONS, "fromto")
_COMPUTED = {
    "mate": "computed from `mate`, to meet the place",
    "mirror": "computed: the mirror image of another part",
    "replicate": "computed: the place of this copy",
}


def bodies(linking: Linking) -> None:
    """Attach the parts in their order. A part that is attached to another part waits for that part."""
    order = _AttachmentOrder(linking)
    tops: dict[Part, Node] = {}
    while ready := order.next():
        for part in ready:
            top = _PartAttachment(linking, part, order.mounts[part]).run()
            if top is not None:
                tops[part] = top
            order.attached(part)
    if not order.waiting:
        _in_order(linking, tops)
        return
    waiting = [*order.waiting.values()]
    lost = [part for part in waiting if part not in order.mounts]
    _report_lost(linking, lost)
    if not lost:
        _report_ring(linking, waiting, order.mounts)
    prefixes = [part.prefix for part in waiting if part.prefix]
    linking.sink.suppress_about([*prefixes, *(each.removesuffix(linking.request.separator) for each in prefixes)])


class _AttachmentOrder:
    """The order in which parts can be attached. Each part is tried again once its element exists.

    A part waits for the part that has its place, for an entry of `add` that makes it, or for the body that another
    attachment makes. Entries are carried out as late as possible, in the order of the parts.
    """

    def __init__(self, linking: Linking) -> None:
        self.linking = linking
        self.numbers = {part: number for number, part in enumerate(linking.parts)}
        self.waiting = {part.unit: part for part in linking.parts}
        self.mounts: dict[Part, Node] = {}
        """The elements of the places that exist, of attached parts and of waiting ones."""
        self.ready: set[int] = set()
        self.nowhere: list[int] = []
        """A heap of the parts whose place an entry may make now."""
        self.until: dict[object, list[Part]] = {}
        """The waiting parts, by the root of another part, or by the kind and the name of an element."""
        for part in linking.parts:
            self._look(part)

    def next(self) -> list[Part]:
        """Return the parts that can be attached now, or none if no part is left or all parts wait for one another."""
        while not self.ready and self.nowhere:
            self._make(self.linking.parts[heappop(self.nowhere)])
        ready = sorted(self.ready)
        self.ready = set()
        return [self.linking.parts[number] for number in ready]

    def attached(self, part: Part) -> None:
        del self.waiting[part.unit]
        self._exists(part.unit.root, ("body", part.prefix))

    def _exists(self, *awaited: object) -> None:
        for each in awaited:
            for part in self.until.pop(each, ()):
                self._look(part)

    def _look(self, part: Part) -> None:
        if part.unit not in self.waiting:
            return
        linking = self.linking
        place = part.place
        if place.kind == "world":
            mount: Node | None = world_of(linking)
        else:
            mount = linking.names.find(place.kind, str(place.name))
        if mount is not None:
            self.mounts[part] = mount
        root = None if mount is None else mount.getroottree().getroot()
        if root is linking.base.root and part.mirrored is not None and part.mirrored.unit in self.waiting:
            self.until.setdefault(part.mirrored.unit.root, []).append(part)
        elif root is linking.base.root:
            self.ready.add(self.numbers[part])
        elif root is not None:
            self.until.setdefault(root, []).append(part)
        else:
            self.until.setdefault((place.kind, place.name), []).append(part)
            heappush(self.nowhere, self.numbers[part])

    def _make(self, part: Part) -> None:
        """Hang up the element with the place of a part, or wait for the element that it is added to."""
        linking = self.linking
        chain = [] if part in self.mounts else waiting(linking, (part.place.kind, str(part.place.name)))
        if not chain:
            return
        holder = holder_of(linking, chain[0])
        root = None if holder is None else holder.getroottree().getroot()
        if root is not linking.base.root:
            self.until.setdefault(chain[0].to if root is None else root, []).append(part)
            return
        for addition in chain:
            inner = holder_of(linking, addition)
            assert inner is not None  # the addition before has it
            linking.watch(linking.units, bodies)  # changes so far belong to the pass
            hang(linking, addition, inner)
            linking.watch(linking.units, addition.step)
        self._exists(*(place for addition in chain for place in addition.places))


def _in_order(linking: Linking, tops: Mapping[Part, Node]) -> None:
    """Restore the order of floating parts in the world, some of which had to wait for their place."""
    if not tops:
        return
    world = linking.base.section("worldbody")
    hung = [tops[part] for part in linking.parts if part in tops and tops[part].getparent() is world]
    if hung != sorted(hung, key={node: at for at, node in enumerate(world)}.__getitem__):
        journal.place_all(world, hung)


def _report_ring(linking: Linking, waiting: list[Part], mounts: Mapping[Part, Node]) -> None:
    by_root = {part.unit.root: part for part in waiting}
    ring = [waiting[0]]
    while ring[-1] not in ring[:-1]:
        last = ring[-1]
        original = None if last.mirrored is None else by_root.get(last.mirrored.unit.root)
        ring.append(original or by_root[mounts[last].getroottree().getroot()])
    host = ring[-1]
    ring = ring[ring.index(host) :]
    message = f"parts are attached to one another: {' to '.join(f'`{part.called}`' for part in ring)}"
    span = host.place.span or host.span
    help = "one of them must be attached to the base or to the world"
    linking.sink.error("attach-cycle", message, span, help=help, subjects=(part.called for part in ring))


def _report_lost(linking: Linking, lost: Iterable[Part]) -> None:
    """Report places that do not exist, and the first part that waits for an element that would be added to itself."""
    waits = False
    for part in lost:
        place = part.place
        name = (place.kind, str(place.name))
        target = outermost_target(linking, name)
        if target is None:
            _report_missing_place(linking, part)
        # An entry that adds to nothing is reported when it is carried out.
        elif not waits and any(linking.names.find(kind, target[1]) is not None for kind in ("body", "frame")):
            waits = True
            which = f"which is added to `{target[1]}`, and that is attached to `{part.called}`"
            message = f"`{part.called}` is attached to the {place.kind} `{place.name}`, {which}"
            notes = (Note(f"the {place.kind} is added here", linking.later_places[name].span),)
            subjects = (part.called, place.name)
            span = place.span or part.span
            help = "add or attach one of them to the base or to the world"
            linking.sink.error("attach-cycle", message, span, notes=notes, help=help, subjects=subjects)


def _report_missing_place(linking: Linking, part: Part) -> None:
    kind = part.place.kind
    name = part.place.name or ""
    added = later_names(linking)

    def known(kind: str) -> list[str]:
        return [each for each in linking.names.known(kind) if not each.startswith(part.prefix or "\0")]

    names = [*known(kind), *(each for of_kind, each in added if of_kind == kind)]
    notes = [exists_note(kind, names, name)]
    kinds = [each for each in linking.names.kinds_of(name) if each != kind]
    other = [*kinds, *(each for each, of_name in added if of_name == name)]
    near = closest(name, names)
    fix = None if other else renaming(name, names)
    help = f"did you mean `{kind}: {near[0]}`?" if near else None
    if (original := original_of(linking.base, kind, name)) is not None:
        fix = None
        notes.insert(0, Note(f"a `<replicate>` makes it from `{original}`, and other elements refer to the copies"))
        help = f"write the copies out in the model, or `{kind}: {original}` for all copies"
    if not near and not names and kind != "body" and (bodies := known("body")):
        notes.append(exists_note("body", bodies, name))
        help = "attach it to a body, with a `pos` if need be: `body: NAME`"
    if usable := [each for each in other if each in _PLACES]:
        help = f"`{name}` is a {usable[0]}: write `{usable[0]}: {name}`"
    elif other:
        what = f"`{name}` is {word(other[0], article=True)}; parts are attached to sites, bodies and frames"
        notes.insert(0, Note(what))
    linking.sink.error(
        "attach-place",
        f"the {kind} `{name}` to attach `{part.called}` to does not exist",
        part.place.span or part.span,
        notes=(*notes, *attached_notes(linking.base, name)),
        help=help,
        subjects=(name, part.called),
        fix=fix,
    )


class _PartAttachment:
    """Attaches one part. The next element goes into `parent` with `pose`, which the recipe sets at `written`."""

    def __init__(self, linking: Linking, part: Part, mount: Node) -> None:
        self.linking = linking
        self.part = part
        self.mount = mount
        self.parent = mount
        self.pose: dict[str, str] = {}
        self.offset = dict(part.place.offset)
        self.written: Mapping[str, Span] = {}

    def _note_copies(self) -> None:
        """Say how many copies of the part MuJoCo makes, if its place is inside of a `<replicate>`."""
        part = self.part
        place = self.part.place
        copies = names_of_copies(self.parent) if place.kind != "world" else []
        if len(copies) > 1:
            message = f"`{part.called}` is attached to all {len(copies)} copies of the {place.kind} `{place.name}`"
            help = f"to attach it to one copy, write `{place.kind}: {copies[0]}`"
            self.linking.sink.note("attach-place", message, place.span or part.span, help=help)

    def run(self) -> Node | None:
        """Attach the part, and return the outermost element created for it, if there is one."""
        part = self.part
        base = self.linking.base
        self._note_copies()
        self._find_pose()
        outer = self.parent
        last = next(self.parent.iterchildren(reversed=True), None)
        if part.sense is not None:
            self._add_sensing_body(part.sense)
        if self.offset:
            if self.pose:  # a frame has one pose, so the site's pose and the recipe's offset need two
                self._enter("frame", {})
            self.pose = self.offset
            self.written = part.place.written
        moves = bool(part.joints or part.mocap)
        if moves:
            self._add_moving_body()
        # In MuJoCo 4.0 the `childclass` of a `<frame>` applies to its contents, and a frame without a pose changes no
        # bit of the bodies inside.
        frame = self._make("frame", {**self.pose, "childclass": self.linking.top_class(part.unit)}, self.written)
        self._move_world(frame)
        if next(frame.iterchildren("*"), None) is not None:
            words = f"carries the part `{part.called}` {place_words(part)}, and its default class"
            journal.place(self.parent, frame, why=because(words, hung_at(part)))
            content = frame
        else:
            journal.place_all(self.parent, frame)  # comments of a part without bodies
            content = self.parent
        if moves:
            _bound_mass(self.linking, self.parent)
        pose = pose_in_world(frame, *_angle_units(self.linking)) if self._needs_pose() else None
        self.linking.attachments[part] = AttachedPart(self.mount, content, pose)
        base.origins.adopt(part.unit.origins)
        base.origins.own(frame, part.unit.file)
        if self.written:
            base.origins.settings[frame] = dict(self.written)
        top = next(outer.iterchildren(reversed=True), None)
        return None if top is last else top

    def _needs_pose(self) -> bool:
        """Return whether keys of the part have poses in the world."""
        keys = self.linking.keys
        layout = keys.layouts.get(self.part)
        if layout is not None and layout.in_world_coordinates:
            return True
        return any(keyed is self.part for keyed, _ in keys.attached)

    def _find_pose(self) -> None:
        """Set the parent and the pose of the place. Report a part that cannot be attached there."""
        part = self.part
        linking = self.linking
        if part.place.kind == "site":
            holder = self.parent.getparent()
            assert holder is not None
            # A site has no content: the part is attached next to it, with its pose.
            self.pose = effective_pose(self.parent, linking.base.classes)
            self.parent = holder
        if (scaled := scaled_above(self.parent)) is not None:
            note = Note("the frame", linking.span(linking.base, scaled, "scale"))
            help = "attach the part outside the frame, or apply the scale to the source"
            self._report_place("it is inside a frame that would scale the part", note, help)
        if part.place.kind != "world" and not part.floats and (joint := _aligned_by(linking, self.parent)) is not None:
            note = Note("the free joint that is aligned", linking.span(linking.base, joint))
            help = 'write `align="false"` on the free joint in the source, or in a copy of it'
            why = "MuJoCo aligns its body with the inertia, which an attached part would prevent"
            self._report_place(why, note, help)
        if part.floats and part.sense is not None:
            message = f"`{part.called}` floats freely: no body carries it, and `sense` has nothing to measure"
            help = "omit `sense`, or fix the part to its place"
            linking.sink.error("attach-place", message, part.sense.span, help=help, subjects=(part.called,))
        original = self._original()
        if part.mirrored is not None and original is not None:
            units = _angle_units(linking)
            image = pose_in_world(original.content, *units).reflected(*part.mirrored.across)
            moved = (pose_in_world(self.parent, *units) @ read_pose(self.pose, *units)).inverse() @ image
            self.offset = {"pos": numbers.text(moved.pos), "quat": numbers.text(moved.quat)}
        if part.floats and part.place.kind != "world":  # a floating part cannot be below a body
            units = _angle_units(linking)
            there = pose_in_world(self.parent, *units) @ read_pose(self.pose, *units)
            there @= read_pose(self.offset, *units)
            self.pose = {"pos": numbers.text(there.pos), "quat": numbers.text(there.quat)}
            self.parent = world_of(linking)
            self.offset = {}

    def _original(self) -> AttachedPart | None:
        """Return the attachment of the part that this part mirrors."""
        attachments = self.linking.attachments
        mirrored = self.part.mirrored
        if mirrored is None:
            return None
        return next((attachments[part] for part in attachments if part.unit is mirrored.unit), None)

    def _report_place(self, why: str, note: Note, help: str) -> None:
        part = self.part
        self.linking.sink.error(
            "attach-place",
            f"`{part.called}` cannot be attached to the {part.place.kind} `{part.place.name}`: {why}",
            part.place.span or part.span,
            notes=(note,),
            help=help,
            subjects=(part.called, part.place.name),
        )

    def _enter(self, tag: str, attributes: Mapping[str, str]) -> Node:
        self.parent = self._add(tag, {**attributes, **self.pose}, self.written)
        self.pose = {}
        self.written = {}
        return self.parent

    def _add(self, tag: str, attributes: Mapping[str, str], written: Mapping[str, Span] | None = None) -> Node:
        """Create an element. `written` has the places of its attributes in the recipe."""
        origins = self.linking.base.origins
        child = self._make(tag, attributes, written or {})
        journal.place(self.parent, child, why=partial(self._why_made, tag))
        if self.part.span is not None:
            origins.own(child, self.part.span)
        if written:
            origins.settings[child] = dict(written)
        return child

    def _make(self, tag: str, attributes: Mapping[str, str], written: Mapping[str, Span]) -> Node:
        element = self.parent.makeelement(tag)
        for name, text in attributes.items():
            journal.write(element, name, text, partial(self._because, name, text, written.get(name)))
        return element

    def _because(self, attribute: str, text: str, written: Span | None) -> Because:
        """Return the reason for a value on the attachment: the recipe's pose and joints, or the place."""
        part = self.part
        is_pose = attribute == "pos" or attribute in ORIENTATIONS
        if written is not None and attribute == "name":
            return Because(f"named there, with the prefix of the part `{part.called}`", written)
        if written is not None:
            return Because(_COMPUTED.get(part.place.computed, "") if is_pose else "", written)
        if attribute in ("class", "childclass") and text == self.linking.top_class(part.unit):
            return Because(f"the top class of the part `{part.called}`", part.span)
        if attribute == "name":
            return Because(f"named after the part `{part.called}`", part.span)
        if is_pose and part.floats:
            return Because("computed: where that place is in the world", hung_at(part))
        if is_pose:
            return Because(f"the pose of the {part.place.kind} `{part.place.name}`", hung_at(part))
        return Because(f"for the part `{part.called}`", part.span)

    def _why_made(self, tag: str) -> Because:
        part = self.part
        if tag == "frame":
            words = f"the pose of the {part.place.kind} that the part `{part.called}` is attached to"
            return Because(words, hung_at(part))
        if tag == "body":
            return Because(f"a body for the joint between the part `{part.called}` and its place", part.span)
        return Because(f"joins the part `{part.called}` to its place", part.span)

    def _add_moving_body(self) -> None:
        linking = self.linking
        part = self.part
        body = self._enter("body", {"name": part.prefix} if part.prefix else {})
        if part.mocap:
            journal.write(body, "mocap", "true", partial(self._because, "mocap", "true", None))
        if any(flex.part is part for flex in linking.notes.flexes):
            journal.write(
                body, "childclass", linking.top_class(part.unit), because("holds for the flex in it", part.span)
            )
        for joint in part.joints:
            added = self._add(joint.tag, self._joint_attributes(joint), joint.written)
            name = str(added.get("name") or "")
            if name:
                message = f"the joint `{name}` that `joint` gives `{part.called}` has the name of another joint"
                self._declare("joint", name, added, message=message, help="choose another name", at=part.span)
        if part.prefix:
            linking.names.declared.setdefault("body", {})[part.prefix] = body

    def _joint_attributes(self, joint: Joint) -> dict[str, str]:
        """Return the attributes of a joint in the model, with those that undo settings of the model for it."""
        linking = self.linking
        if joint.tag == "freejoint":
            return {**({"align": "false"} if linking.notes.aligned else {}), **joint.attributes}
        attributes = {**undo_settings(linking.notes.main_joint), **joint.attributes}
        if joint.top_class_of is not None:
            attributes["class"] = linking.top_class(joint.top_class_of)
        return attributes

    def _add_sensing_body(self, sense: SensorBody) -> None:
        """Create the body that carries the part, with its site and its sensors."""
        unit = self.part.unit
        body = self._enter("body", {"name": sense.name})
        site = self._add("site", {"name": sense.name})
        # The classes of the place are for other sites.
        if self.linking.base.classes.give("site", *_GIVEN):
            own = {"class": MAIN, "pos": "0 0 0", "quat": "1 0 0 0"}
            journal.write_all(site, own, because("the classes of the place are for other sites", sense.span))
        made = [("body", sense.name, body), ("site", sense.name, site)]
        with explained(BRINGS):
            section = unit.section("sensor")
        for tag, name in reversed(sense.sensors):
            sensor = section.makeelement(tag)
            with explained(because(f"measures the load of the part `{self.part.called}`", sense.span)):
                journal.write_all(sensor, {"name": name, "site": sense.name})
                if sense.cutoff:
                    journal.write(sensor, "cutoff", sense.cutoff)
                journal.place(section, sensor, 0)
            unit.origins.own(sensor, sense.span)
            made.append(("sensor", name, sensor))
        for kind, name, node in made:
            self.linking.base.origins.own(node, sense.span)
            message = f"`sense` of `{self.part.called}` makes the {kind} `{name}`, and the model has one of that name"
            help = "give it another name: `sense: {name: wrist, force: true}`"
            self._declare(kind, name, node, message=message, help=help, at=sense.span)

    def _declare(self, namespace: str, name: str, node: Node, *, message: str, help: str, at: Span | None) -> None:
        linking = self.linking
        earlier = linking.names.declared.setdefault(namespace, {}).setdefault(name, node)
        if earlier is not node:
            note = Note("it is declared here", linking.span(self.part.unit, earlier, "name"))
            linking.sink.error("name-clash", message, at, notes=(note,), help=help, subjects=(name, self.part.called))

    def _move_world(self, frame: Node) -> None:
        """Move the elements in the worldbody of the part into its frame, with the comments above them."""
        unit = self.part.unit
        # MuJoCo reads several `<worldbody>` as one, in their order.
        for worldbody in list(unit.root.iterchildren("worldbody")):
            owner = unit.origins.owners.get(worldbody)
            if owner is not None:  # it was included from another file
                for child in worldbody:
                    unit.origins.owners.setdefault(child, owner)
            journal.place_all(frame, [*above(worldbody, unit.header), *worldbody], partial(_hung, self.part))
            journal.remove(worldbody)
            journal.note_source(self.linking.base.section("worldbody"), worldbody)
        # The comments at the top of a file are written once, above the first part that is made of it.
        first = next(each for each in self.linking.parts if each.unit.file == unit.file)
        if unit.header and first is self.part:
            for comment in reversed(unit.header):
                journal.place(frame, comment, 0)


def _hung(part: Part) -> Because:
    return Because(f"hung {place_words(part)}", hung_at(part))


def place_words(part: Part) -> str:
    """Return in words where a part is attached."""
    place = part.place
    where = "in the world" if place.kind == "world" else f"on the {place.kind} `{place.name}`"
    return f"{where}, with an offset" if place.offset else where


def hung_at(part: Part) -> Span | None:
    """Return where the recipe says the place of a part."""
    return part.place.span or part.span


def _bound_mass(linking: Linking, body: Node) -> None:
    # MuJoCo 4.0 raises mass and moments of each body to `boundmass` and `boundinertia`, those of 0, too.
    least = linking.base.settings.boundmass
    moment = linking.base.settings.boundinertia
    raises = numbers.first(least) or numbers.first(moment)
    if raises and not any(has_mass(geom, linking.base.classes) for geom in own(body, "geom")):
        inertial = {"pos": "0 0 0", "mass": least, "diaginertia": f"{moment} {moment} {moment}"}
        why = because("the least mass and inertia of a body, by `boundmass` and `boundinertia` of the base")
        journal.place(body, body.makeelement("inertial", inertial), 0, why)


def _aligned_by(linking: Linking, mount: Node) -> Node | None:
    """Return the free joint of the mount's body if MuJoCo aligns the body as long as nothing is attached to it."""
    body = mount if mount.tag == "body" else next(mount.iterancestors("body"), None)
    if body is None or not is_leaf(body):
        return None
    by_default = str(linking.notes.aligned).lower()
    for child in through_frames(body):
        align = child.get("align") or "auto"
        is_free = child.tag in JOINTS and joint_type(child, linking.base.classes) == "free"
        if is_free and (by_default if align == "auto" else align) == "true":
            return child
    return None


def _angle_units(linking: Linking) -> tuple[bool, str]:
    return linking.angle == "degree", linking.base.settings.eulerseq


def effective_pose(site: Node, classes: Classes) -> dict[str, str]:
    """Return the effective pose attributes of a site, including its classes. `fromto` is converted to a pose."""
    written = {name: str(site.get(name)) for name in _GIVEN if site.get(name)}
    name = site.get("class") or childclass_of(site)
    found = classes.get(str(name) if name else None) if classes.give("site", *_GIVEN) else None
    if found is not None:
        tag = default_tag(site)
        inherited = {name: value[0] for name in ("pos", "fromto") if (value := found.lookup(tag, name))}
        turned = found.orientation(tag)
        # Any orientation replaces any other: with `<site euler="90 0 0"/>` in the class, MuJoCo 4.0 compiles
        # `<site quat="1 0 0 0"/>` to 1 0 0 0.
        if turned and written.keys().isdisjoint(ORIENTATIONS):
            inherited[turned[0]] = turned[1]
        written = {**inherited, **written}
    ends = numbers.read(written.pop("fromto", ""))
    if len(ends) == 6 and not any(map(math.isnan, ends)):
        # The z axis points from the second end to the first: MuJoCo 4.0 turns `<site fromto="0 0 0 1 0 0" …/>` as it
        # does `<site zaxis="-1 0 0"/>`. Six `nan` revert a class.
        start = ends[:3]
        end = ends[3:]
        middle = [0.5 * (a + b) for a, b in zip(start, end, strict=True)]
        return {"pos": numbers.text(middle), "zaxis": numbers.text([a - b for a, b in zip(start, end, strict=True)])}
    return written
