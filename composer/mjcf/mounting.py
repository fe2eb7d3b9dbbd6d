"""Turn attachments into the linker's parts: the place of each model, its offset and its joints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.link.angles import model_angle
from composer.link.linking import Linking
from composer.link.numbers import joint_radians, read
from composer.link.numbers import text as number_text
from composer.link.part import Joint, Part, Place
from composer.link.placing import read_pose
from composer.mjcf.errors import failure
from composer.mjcf.model import Attachment, Model
from composer.tree.classes import MAIN, ORIENTATIONS, childclass_of
from composer.tree.counterpart import counterpart
from composer.tree.kinds import WORLD_SECTION
from composer.tree.name_index import UP, NameIndex
from composer.tree.unit import Unit

_ANGULAR = {"hinge": ("range", "ref", "springref", "springyield"), "ball": ("range", "springyield")}
# What a free joint says in either spelling; anything else only `<joint type="free">` can have.
_OF_FREEJOINTS = frozenset({"name", "class", "group", "type"})


@dataclass(slots=True)
class _Mounted:
    """An attachment with its copies: the part, the prefix of the parent, and the element it is attached to."""

    attachment: Attachment
    part: Part
    parent_unit: Unit
    parent_prefix: str
    host: Node


@dataclass(slots=True)
class Mounting:
    """Copies of a model and all models attached below it, ready to be linked.

    The linker finds places by name. Places without a name get one in the copies until `clear_up`.
    """

    model: Model
    copy: Callable[[Model], Unit]
    base: Unit = field(init=False)
    mounted: list[_Mounted] = field(init=False, default_factory=list)
    named: list[Node] = field(init=False, default_factory=list)
    added: list[Node] = field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        self.base = self.copy(self.model)
        self._mount(self.model, self.base, "", None)

    @property
    def parts(self) -> list[Part]:
        return [each.part for each in self.mounted]

    def _mount(self, model: Model, unit: Unit, prefix: str, own: _Mounted | None) -> None:
        """Append all models attached to `model`, each before the models attached to it."""
        hosts = [counterpart(each.host, model.unit.root, unit.root) for each in model.attachments.values()]
        for attachment, host in zip(model.attachments.values(), hosts, strict=True):
            copied = self.copy(attachment.child)
            place = self._place(attachment, host, unit, prefix, own)
            part = Part(
                copied,
                prefix + attachment.child.prefix,
                place,
                keyframes="prefix",
                mocap=attachment.frame.get("mocap") == "true",
                span=model.span(attachment.frame),
                outward=_outward(attachment.child, self.model),
            )
            mounted = _Mounted(attachment, part, unit, prefix, host)
            self.mounted.append(mounted)
            self._mount(attachment.child, copied, part.prefix, mounted)

    def _place(
        self, attachment: Attachment, host: Node, unit: Unit, prefix: str, own: _Mounted | None
    ) -> Place:
        offset = _offset(attachment.frame, unit)
        if host.tag == WORLD_SECTION:
            if own is None:
                return Place("world", None, offset)
            outer = own.part.place
            if outer.kind == "world" and not own.attachment.is_body:
                return replace(outer, offset=_combined(outer.offset, offset))
            frame = host.makeelement("frame")
            host.append(frame)
            self.added.append(frame)
            host = frame
        kind = str(host.tag)
        if not host.get("name"):
            host.set("name", _free_name(attachment.parent.names, kind, len(self.named)))
            self.named.append(host)
        return Place(kind, prefix + str(host.get("name")), offset)  # type: ignore[arg-type]

    def add_joints(self, linking: Linking) -> None:
        """Set the joints of each part from its attachment frame. The linker must have named the top classes before."""
        tops = {each.part.prefix: each.part.top_class for each in self.mounted}
        tops[""] = linking.base_class or MAIN
        in_radians = model_angle(linking) == "radian"
        for each in self.mounted:
            to_radians = in_radians and each.parent_unit.settings.angle == "degree"
            each.part.joints = tuple(
                _joint(joint, each, tops[each.parent_prefix], to_radians) for joint in each.attachment.frame
            )

    def clear_up(self) -> None:
        """Remove the names and frames that were added for the linker."""
        for node in self.named:
            del node.attrib["name"]
        for frame in self.added:
            parent = frame.getparent()
            if parent is not None:
                at = parent.index(frame)
                parent[at : at + 1] = list(frame)


def _outward(model: Model, top: Model) -> dict[str, str]:
    """Return the final names of what a model refers to in the models above it and beside it."""
    found: dict[str, str] = {}
    for uses in model.names.uses.values() if model.names.leads_out else ():
        for name in uses:
            here, rest = model, name
            while rest.startswith(UP) and here is not top and here.hung is not None:
                here, rest = here.hung.parent, rest[len(UP) :]
            if here is not model:
                found[name] = str(top.prefix_of(here)) + rest
    return found


def _offset(frame: Node, unit: Unit) -> dict[str, str]:
    """Return the pose attributes of a frame. Angles become a quaternion, since the other model's unit may differ."""
    written = {name: str(frame.get(name)) for name in ("pos", *ORIENTATIONS) if frame.get(name)}
    for name in ("euler", "axisangle"):
        if written.pop(name, None):
            settings = unit.settings
            pose = read_pose(frame, settings.angle == "degree", settings.eulerseq)
            written["quat"] = number_text(pose.quat)
    return written


def _combined(outer: Mapping[str, str], inner: Mapping[str, str]) -> dict[str, str]:
    """Return the combination of an outer and an inner offset, neither of which has angles."""
    if not outer or not inner:
        return {**outer, **inner}
    pose = read_pose(outer, False, "xyz") @ read_pose(inner, False, "xyz")
    return {"pos": number_text(pose.pos), "quat": number_text(pose.quat)}


def _free_name(names: NameIndex, kind: str, number: int) -> str:
    name = f"attachment-{number}"
    while names.find(kind, name) is not None:
        name += "-"
    return name


def _joint(joint: Node, mounted: _Mounted, top_class: str, to_radians: bool) -> Joint:
    """Return a joint of an attachment frame for the flat model. Its default classes are those of the parent."""
    part, unit = mounted.part, mounted.parent_unit
    attributes = {str(name): str(value) for name, value in joint.items()}
    attributes["name"] = part.prefix + attributes.get("name", "")
    if joint.tag == "freejoint":
        return Joint("freejoint", attributes)
    written = attributes.get("class") or childclass_at(mounted.host)
    found = unit.classes.get(written)
    kind = attributes.get("type")
    if kind is None:
        inherited = found.lookup("joint", "type")
        kind = inherited[0] if inherited else "hinge"
    if kind == "free":
        if attributes.keys() <= _OF_FREEJOINTS:
            return Joint("freejoint", {k: v for k, v in attributes.items() if k in ("name", "group")})
        if part.place.kind != "world":
            parent = mounted.attachment.parent
            raise failure(
                "not-supported",
                f"the free joint of `{part.prefix}` has settings of its own, and can stand in the world only",
                parent.span(joint),
                help="use a `freejoint`, or attach the model to the worldbody",
            )
    attributes["class"] = top_class if written in (None, MAIN) else mounted.parent_prefix + written
    if to_radians:
        for name in _ANGULAR.get(kind, ()):
            value = attributes.get(name)
            if value and not (name == "range" and attributes.get("limited") == "false"):
                attributes[name] = number_text(map(joint_radians, read(value)))
    return Joint("joint", attributes)


def childclass_at(host: Node) -> str | None:
    """Return the name of the class in force for elements added at an attachment's host, or None."""
    own = host.get("childclass")
    return str(own) if own and host.tag != "site" else childclass_of(host)
