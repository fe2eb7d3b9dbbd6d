"""Read and check models, and make them the linker's parts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, replace
from functools import cache

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note, unknown_attribute
from mjcompose.link.linking import AttachmentPlace, Joint, Part, common_angle
from mjcompose.link.numbers import joint_radians, read, read_pose, text as number_text
from mjcompose.link.settings import INSTEAD_OF_MEMORY
from mjcompose.mjcf.errors import failure
from mjcompose.mjcf.model import AttachedModel, ModelState
from mjcompose.mujoco.messages import of_other_version
from mjcompose.tree.classes import MAIN, ORIENTATIONS, childclass_of
from mjcompose.tree.edit import whole
from mjcompose.tree.files import stem
from mjcompose.tree.grammar import GRAMMAR, ElementType
from mjcompose.tree.names import DECLARES, MAY_REPEAT, UP, NameIndex, declaration, naming_table, own_name
from mjcompose.tree.select import WORLD_SECTION, section_of
from mjcompose.tree.unit import Unit, counterpart
from mjcompose.tree.xml_faults import ignored, is_unread_alone

_STAND_IN = "stands in for what is attached"
# The targets of an actuator, and the attributes that depend on them.
_OF_TRANSMISSIONS = ("joint", "jointinparent", "tendon", "slidersite", "cranksite", "site", "refsite", "inheritrange")
# Sections of bodies, of their mass and of their materials.
_OF_BODIES = frozenset({"worldbody", "default", "asset", "extension"})


def without_outward(unit: Unit, prefixes: tuple[str, ...]) -> Unit:
    """Return the unit, or a copy without the elements that refer to names with one of the prefixes.

    Bodies and the elements on them stay. Their references to materials with these names are removed; if another name
    is missing, MuJoCo reports it. Actuators stay, in their order, and act on a placeholder site.
    """
    if not _outward_references(NameIndex.of(unit.root), prefixes):
        return unit
    unit = unit.copied()
    names = NameIndex.of(unit.root)
    waiting = _outward_references(names, prefixes)
    while waiting:
        namespace, name = waiting.pop()
        for node, attribute in names.users(namespace, name):
            section = section_of(node)
            if section == "actuator" and node.get("body"):
                node.set("body", "world")
            elif section == "actuator":
                for name in _OF_TRANSMISSIONS:
                    node.attrib.pop(name, "")
                world = unit.section("worldbody")
                if all(site.get("name") != _STAND_IN for site in world.iterchildren("site")):
                    world.append(world.makeelement("site", {"name": _STAND_IN}))
                node.set("site", _STAND_IN)
            elif section not in _OF_BODIES:
                top = whole(node)
                declared = declaration(top, section)
                parent = top.getparent()
                if parent is not None:
                    parent.remove(top)
                    waiting += [declared] if declared else []
            elif namespace == "material":
                del node.attrib[attribute]
    return unit


def _outward_references(names: NameIndex, prefixes: tuple[str, ...]) -> list[tuple[str, str]]:
    return [
        (namespace, name)
        for namespace, uses in names.uses.items()
        for name in uses
        if name.startswith(prefixes) and names.find(namespace, name) is None
    ]


# Sections whose elements are named after their file where they have no `name`.
_NAMED_AFTER_FILE = ("asset", "deformable")

_Row = dict[str, dict[str, frozenset[str]]]


def check_tree(unit: Unit, sink: Sink) -> None:
    """Report elements and attributes that MJCF does not have, and names that repeat. Values are not checked."""
    names: list[tuple[object, str | None]] = []
    for section in unit.root.iterchildren("*"):
        tag = str(section.tag)
        if tag not in GRAMMAR.root.children:
            _unknown_element(unit, section, GRAMMAR.root, sink=sink)
            continue
        table = _table(tag)
        namespaces = _namespaces(tag)
        _check_attributes(unit, section, GRAMMAR.section(tag), sink=sink)
        for parent in section.iter("*"):
            allowed = table.get(parent.tag) if len(parent) else None
            if allowed is None:  # if it has children, it was reported as a child of its parent
                continue
            for child in parent:
                kind = child.tag
                attributes = allowed.get(kind)
                if attributes is None:
                    if isinstance(kind, str):
                        _unknown_element(unit, child, _kind(tag, str(parent.tag)), sink=sink)
                    continue
                keys = child.keys()
                if not attributes.issuperset(keys):
                    _check_attributes(unit, child, _kind(tag, str(parent.tag)).children[kind], sink=sink)
                if "name" in keys:
                    names.append((namespaces.get(kind), child.get("name")))
                elif "file" in keys and tag in _NAMED_AFTER_FILE:
                    names.append((namespaces.get(kind), stem(str(child.get("file")))))
                elif kind == "default":
                    names.append((None, child.get("class")))
    if not GRAMMAR.root.attributes.keys() >= set(unit.root.keys()):
        _check_attributes(unit, unit.root, GRAMMAR.root, sink=sink)
    if len(set(names)) < len(names):  # or seemingly so
        _check_names(unit, sink)


def _check_names(unit: Unit, sink: Sink) -> None:
    first: dict[tuple[str, str], Node] = {}
    for section in unit.root.iterchildren("*"):
        namespaces = _namespaces(str(section.tag))
        if namespaces:
            for node in section.iterdescendants(*namespaces):
                attribute, namespace = namespaces[str(node.tag)]
                name = own_name(node, attribute)
                if name and first.setdefault((namespace, name), node) is not node:
                    code = "name-clash"
                    kind = namespace
                    if namespace == "default":
                        code = "class-clash"
                        kind = "default class"
                    span = unit.origins.span(node, unit.file, attribute if node.get(attribute) else "file")
                    notes = (Note("the first one is here", unit.origins.span(first[namespace, name], unit.file)),)
                    message = f"another {kind} is already called `{name}`"
                    help = "give one of the two another name"
                    sink.error(code, message, span, notes=notes, help=help)


def one_of_each_section(unit: Unit) -> None:
    """Merge sections that are written several times. If a setting repeats, the last value wins."""
    first: dict[str, Node] = {}
    for section in list(unit.root.iterchildren("*")):
        tag = str(section.tag)
        if tag == "default" or first.setdefault(tag, section) is section:
            continue  # a later default section does not reach the classes of an earlier one
        owner = unit.origins.owner(section, unit.file)
        for child in section.iterchildren("*"):
            if child not in unit.origins.owners:
                unit.origins.own(child, owner)
        # MuJoCo lets `memory` override the older size settings, but refuses both in one element.
        if tag == "size":
            for there, here in ((first[tag], section), (section, first[tag])):
                if there.get("memory"):
                    for name in INSTEAD_OF_MEMORY:
                        here.attrib.pop(name, "")
        _merge_sections(first[tag], section, GRAMMAR.section(tag))
        unit.root.remove(section)


def _merge_sections(into: Node, section: Node, kind: ElementType) -> None:
    for name, value in section.items():
        if str(value).strip():
            into.set(name, value)
    for child in list(section):
        once = isinstance(child.tag, str) and kind.children[child.tag].max_count == 1
        same = next(into.iterchildren(child.tag), None) if once else None
        if same is None:
            into.append(child)
        else:
            _merge_sections(same, child, kind.children[str(child.tag)])


@cache
def _table(section: str) -> _Row:
    """Return, for each tag in a section, the children that it can have and their attributes."""
    return {
        tag: {name: frozenset(child.attributes) for name, child in _kind(section, tag).children.items()}
        for tag in (section, *GRAMMAR.within(section))
    }


@cache
def _namespaces(section: str) -> dict[str, tuple[str, str]]:
    """Return, for each tag of a section that declares names, the naming attribute and the namespace."""
    return {
        tag: (attribute, namespace)
        for tag, actions in naming_table(section).items()
        for attribute, (kind, namespace) in actions.items()
        if kind == DECLARES and namespace not in MAY_REPEAT
    }


def _kind(section: str, tag: str) -> ElementType:
    return GRAMMAR.section(section) if tag == section else GRAMMAR.within(section)[tag]


def _unknown_element(unit: Unit, node: Node, parent: ElementType, sink: Sink) -> None:
    tag = str(node.tag)
    span = unit.origins.span(node, unit.file)
    other = of_other_version(node, None, unit.file)
    if other is not None:
        sink.add(replace(other, span=span))
        return
    notes = (exists_note("element", sorted(parent.children), tag),)
    message = f"`<{parent.tag}>` cannot have a `<{tag}>`"
    sink.error("unknown-element", message, span, notes=notes, help=did_you_mean(tag, parent.children, "<{}>"))


def _check_attributes(unit: Unit, node: Node, kind: ElementType, sink: Sink) -> None:
    for name in map(str, node.keys()):
        if name in kind.attributes:
            continue
        if is_unread_alone(node, name, unit):
            sink.add(ignored(node, name, unit))
            continue
        other = of_other_version(node, name, unit.file)
        found = other or unknown_attribute(name, f"`<{kind.tag}>`", sorted(kind.attributes))
        sink.add(replace(found, span=unit.origins.span(node, unit.file, name)))


_ANGULAR = {"hinge": ("range", "ref", "springref", "springyield"), "ball": ("range", "springyield")}
# Attributes of a free joint in either spelling; only `<joint type="free">` can have others.
_OF_FREEJOINTS = frozenset({"name", "class", "group", "type"})


class _Mounted(Struct):
    """An attachment with its copies: the unit and its place, and the unit and the element it is attached to."""

    attachment: AttachedModel
    unit: Unit
    prefix: str
    place: AttachmentPlace
    parent_unit: Unit
    parent_prefix: str
    host: Node


class Mounting(Struct, frozen=False):
    """Copies of a model and all models attached below it, ready to be linked.

    The linker finds places by name. Places without a name get one in the copies until `clear_up`.
    """

    model: ModelState
    copy: Callable[[ModelState], Unit]
    base: Unit = field(init=False)
    mounted: list[_Mounted] = field(init=False, default_factory=list)
    named: list[Node] = field(init=False, default_factory=list)
    added: list[Node] = field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        self.base = self.copy(self.model)
        self._mount(self.model, self.base, "", own=None)

    @property
    def units(self) -> list[Unit]:
        return [self.base, *[mounted.unit for mounted in self.mounted]]

    def parts(self) -> list[Part]:
        """Return the attached models as parts for the linker."""
        in_radians = common_angle(self.units) == "radian"
        return [self._part(mounted, in_radians) for mounted in self.mounted]

    def _part(self, mounted: _Mounted, in_radians: bool) -> Part:
        attachment = mounted.attachment
        to_radians = in_radians and mounted.parent_unit.settings.angle == "degree"
        return Part(
            mounted.unit,
            mounted.prefix,
            mounted.place,
            keyframes="prefix",
            joints=tuple(_joint(joint, mounted, to_radians) for joint in attachment.frame),
            mocap=attachment.frame.get("mocap") == "true",
            span=attachment.parent.span(attachment.frame),
            outward=_outward_names(attachment.child, self.model),
        )

    def _mount(self, model: ModelState, unit: Unit, prefix: str, own: _Mounted | None) -> None:
        """Append all models attached to `model`, each before the models attached to it."""
        hosts = [counterpart(each.host, model.unit.root, unit.root) for each in model.attachments.values()]
        for attachment, host in zip(model.attachments.values(), hosts, strict=True):
            copied = self.copy(attachment.child)
            place = self._place(attachment, host, unit, prefix=prefix, own=own)
            own_prefix = prefix + attachment.child.prefix
            mounted = _Mounted(attachment, copied, own_prefix, place, unit, parent_prefix=prefix, host=host)
            self.mounted.append(mounted)
            self._mount(attachment.child, copied, own_prefix, own=mounted)

    def _place(
        self, attachment: AttachedModel, host: Node, unit: Unit, prefix: str, own: _Mounted | None
    ) -> AttachmentPlace:
        offset = _offset(attachment.frame, unit)
        if host.tag == WORLD_SECTION:
            if own is None:
                return AttachmentPlace("world", None, offset)
            outer = own.place
            if outer.kind == "world" and not own.attachment.is_body:
                if outer.offset and offset:  # neither has angles
                    pose = read_pose(outer.offset, False, "xyz") @ read_pose(offset, False, "xyz")
                    return replace(outer, offset={"pos": number_text(pose.pos), "quat": number_text(pose.quat)})
                return replace(outer, offset={**outer.offset, **offset})
            frame = host.makeelement("frame")
            host.append(frame)
            self.added.append(frame)
            host = frame
        kind = str(host.tag)
        if not host.get("name"):
            name = f"attachment-{len(self.named)}"
            while attachment.parent.names.find(kind, name) is not None:
                name += "-"
            host.set("name", name)
            self.named.append(host)
        return AttachmentPlace(kind, prefix + str(host.get("name")), offset)  # type: ignore[arg-type]

    def clear_up(self) -> None:
        """Remove the names and frames that were added for the linker."""
        for node in self.named:
            del node.attrib["name"]
        for frame in self.added:
            parent = frame.getparent()
            if parent is not None:
                at = parent.index(frame)
                parent[at : at + 1] = list(frame)


def _outward_names(model: ModelState, top: ModelState) -> dict[str, str]:
    """Return the final names of a model's references to the models above it and next to it."""
    found: dict[str, str] = {}
    if model.names.leads_out:
        for uses in model.names.uses.values():
            for name in uses:
                here = model
                rest = name
                while rest.startswith(UP) and here is not top and here.hung is not None:
                    here = here.hung.parent
                    rest = rest[len(UP) :]
                if here is not model:
                    found[name] = str(top.prefix_of(here)) + rest
    return found


def _offset(frame: Node, unit: Unit) -> dict[str, str]:
    """Return the pose attributes of a frame. Angles become a quaternion, since the other model's unit may differ."""
    written = {name: str(frame.get(name)) for name in ("pos", *ORIENTATIONS) if frame.get(name)}
    for name in ("euler", "axisangle"):
        if written.pop(name, None):
            settings = unit.settings
            written["quat"] = number_text(read_pose(frame, settings.angle == "degree", settings.eulerseq).quat)
    return written


def _joint(joint: Node, mounted: _Mounted, to_radians: bool) -> Joint:
    """Return a joint of an attachment frame for the linker. It has the default classes of the parent."""
    unit = mounted.parent_unit
    attributes = {str(name): str(value) for name, value in joint.items()}
    attributes["name"] = mounted.prefix + attributes.get("name", "")
    if joint.tag == "freejoint":
        return Joint("freejoint", attributes)
    written = attributes.get("class") or childclass_at(mounted.host)
    found = unit.classes.get(written)
    kind = attributes.get("type", (found.lookup("joint", "type") or ("hinge",))[0])
    if kind == "free":
        if attributes.keys() <= _OF_FREEJOINTS:
            return Joint("freejoint", {k: v for k, v in attributes.items() if k in ("name", "group")})
        if mounted.place.kind != "world":
            parent = mounted.attachment.parent
            message = f"the free joint of `{mounted.prefix}` has settings of its own, and can be in the world only"
            help = "use a `freejoint`, or attach the model to the worldbody"
            raise failure("not-supported", message, parent.span(joint), help=help)
    has_own_class = written not in (None, MAIN)
    if has_own_class:
        attributes["class"] = f"{mounted.parent_prefix}{written}"
    if to_radians:
        for name in _ANGULAR.get(kind, ()):
            value = attributes.get(name)
            if value and not (name == "range" and attributes.get("limited") == "false"):
                attributes[name] = number_text(map(joint_radians, read(value)))
    return Joint("joint", attributes, top_class_of=None if has_own_class else unit)


def childclass_at(host: Node) -> str | None:
    """Return the name of the class in force for elements added at an attachment's host, or None."""
    own = host.get("childclass")
    return str(own) if own and host.tag != "site" else childclass_of(host)
