"""Converting a URDF for MuJoCo: the places of its elements, and the faults reported there."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from dataclasses import field
from functools import partial
from itertools import takewhile
from pathlib import Path

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.files import Refused
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.mujoco.messages import EngineMessage, Sentence, Topic, read_sentence, translate
from mjcompose.tree.files import is_absolute, join, stem
from mjcompose.tree.unit import Origins, Unit, line_of

_VALUES = {
    "inertial": {"mass": ("mass", "value"), "pos": ("origin", "xyz"), "quat": ("origin", "rpy")},
    "joint": {
        "axis": ("axis", "xyz"),
        "range": ("limit", "upper"),
        "actfrcrange": ("limit", "effort"),
        "damping": ("dynamics", "damping"),
        "frictionloss": ("dynamics", "friction"),
    },
    "geom": {
        "pos": ("origin", "xyz"),
        "quat": ("origin", "rpy"),
        "mesh": ("geometry/mesh", "filename"),
        "rgba": ("material/color", "rgba"),
    },
    "mesh": {"file": (".", "filename"), "scale": (".", "scale")},
}
"""For attributes of MJCF, the element below the URDF's, and the attribute there."""


def name_fused_links(root: Node) -> None:
    """Remove the empty frames that mark links; a link that is no longer a body passes its name to its replacement."""
    bodies = {body.get("name") for body in root.iter("body")}
    for body in root.iter("body"):
        body.attrib.pop("fuse", "")  # MuJoCo has done it already
    for mark in [frame for frame in root.iter("frame") if frame.get("name")]:
        holder = mark.getparent()
        name = mark.get("name")
        assert holder is not None and name is not None
        if name not in bodies and not (holder.tag == "frame" and not holder.get("name")):
            continue
        if name not in bodies:
            holder.set("name", name)
        holder.remove(mark)


def locate_in_urdf(unit: Unit, robot: Node, written: Origins) -> list[tuple[Node, Node]]:
    """Give every element of `unit`, converted from `robot`, its place in the URDF, where `written` finds it.

    The pairs are these elements with their origins.
    """
    unit.origins.texts.update(written.texts)
    pairs = list(_Sources(robot).of(unit.root))
    for element, source in pairs:
        locate_as(unit, element, source, written=written)
    return pairs


def locate_as(unit: Unit, element: Node, source: Node, written: Origins) -> None:
    """Give an element of `unit` the place of the URDF element that it comes from."""
    unit.origins.own(element, partial(_place, written, unit.file, source, _VALUES.get(str(element.tag), {})))


def _place(
    written: Origins, file: str, source: Node, values: dict[str, tuple[str, str]], attribute: str | None
) -> Span:
    path, name = values.get(attribute or "", (".", attribute))
    holder = source.find(path)
    return written.span(*((source, file, None) if holder is None else (holder, file, name)))


def mesh_of(robot: Node, file: str) -> Node:
    """Return the `<mesh>` of a URDF that names a file, whose path may have been shortened or resolved."""
    steps = _steps(file)
    best = robot
    alike = 0
    for mesh in robot.iterfind("link/*/geometry/mesh"):
        pairs = zip(steps, _steps(str(mesh.get("filename"))), strict=False)
        same = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))
        if same > alike:
            best = mesh
            alike = same
    return best


def _steps(path: str) -> list[str]:
    return path.replace("\\", "/").split("/")[::-1]


def by_name(holder: Node, tag: str) -> dict[str, Node]:
    """Return the children of a tag by their names."""
    return {str(each.get("name")): each for each in holder.iterchildren(tag)}


def written_name(element: Node) -> str:
    """Return the tag as the file has it: `drake:joint`, which MuJoCo does not read as a `joint`.

    The prefix need not be declared. lxml then reads `drake:joint` as a tag, but builds no element with that tag.
    """
    tag = str(element.tag).rpartition("}")[2]
    return tag if element.prefix is None else f"{element.prefix}:{tag}"


class _Sources:
    def __init__(self, robot: Node) -> None:
        self.robot = robot
        self.links = by_name(robot, "link")
        self.joints = by_name(robot, "joint")

    def of(self, root: Node) -> Iterator[tuple[Node, Node]]:
        yield root, self.robot
        own = self.robot.find("mujoco")
        for section in root.iterchildren("*"):
            if section.tag == "worldbody":
                yield from self._held(section, self.robot)
            elif section.tag == "asset":
                yield from ((mesh, mesh_of(self.robot, str(mesh.get("file")))) for mesh in section.iterchildren("mesh"))
            elif section.tag == "equality":
                for each in section.iterchildren("*"):
                    joint = self.joints.get(str(each.get("joint1")))
                    mimic = None if joint is None else joint.find("mimic")
                    yield each, self.robot if mimic is None else mimic
            elif own is not None and (found := own.find(str(section.tag))) is not None:
                yield section, found

    def _held(self, holder: Node, link: Node) -> Iterator[tuple[Node, Node]]:
        """Yield the contents of the body, the frame or the world that replaced `link`."""
        geoms = list(holder.iterchildren("geom"))
        yield from zip(geoms, _shapes(link, len(geoms)), strict=True)
        for child in holder.iterchildren("body", "frame", "inertial", "joint"):
            name = str(child.get("name"))
            if child.tag == "inertial":
                found = link.find("inertial")
                yield child, link if found is None else found
            elif child.tag == "joint":
                planar = name[:-3] if name.endswith(("_TX", "_TY", "_RZ")) else name
                yield child, self.joints.get(name, self.joints.get(planar, link))
            else:
                inner = self.links.get(name, link)
                yield child, inner
                yield from self._held(child, inner)


def _shapes(link: Node, number: int) -> list[Node]:
    """Return the shapes of a link that became that many geoms.

    These are the collision shapes, all shapes, or the visual shapes, whichever have that number; otherwise the link
    itself for each geom.
    """
    for tags in (("collision",), ("visual", "collision"), ("visual",)):
        shapes = list(link.iterchildren(*tags))
        if len(shapes) == number:
            return shapes
    return [link] * number


PACKAGE = "package://"
SCHEMES = (PACKAGE, "model://")
_FILE = "file://"


class Appearance(Struct):
    """The color of a mesh or material of URDF, and its picture as PNG, if it has them."""

    rgba: tuple[float, ...] | None
    texture: bytes | None = None


class Robot(Struct, frozen=False):
    """`unit` has the tree of the URDF, and `packages` has the folders of the packages that it names.

    While nothing is `changed`, MuJoCo reads the file itself. `made` has converted meshes by their names in the tree,
    and `looks` has their colors and pictures.
    """

    unit: Unit
    path: Path
    packages: Mapping[str, Path]
    changed: bool = False
    made: dict[str, bytes] = field(default_factory=dict)
    looks: dict[str, Appearance] = field(default_factory=dict)

    @property
    def root(self) -> Node:
        return self.unit.root

    def setting(self, name: str) -> str | None:
        """Return an attribute of the last `<mujoco><compiler>` that has it."""
        return last_setting(self.root, name)

    def set(self, name: str, value: str) -> None:
        if self.setting(name) == value:
            return
        self.changed = True
        if self.root.find("mujoco/compiler") is None:
            holder = self.root.find("mujoco")
            etree.SubElement(etree.SubElement(self.root, "mujoco") if holder is None else holder, "compiler")
        for each in self.root.iterfind("mujoco/compiler"):
            each.set(name, value)

    @property
    def keeps_visuals(self) -> bool:
        return self.setting("discardvisual") == "false"

    def used_meshes(self) -> Iterator[Node]:
        """Yield the meshes that MuJoCo reads."""
        tags = ("collision", "visual") if self.keeps_visuals else ("collision",)
        for link in self.root.iterchildren("link"):
            for shape in link.iterchildren(*tags):
                yield from shape.iterfind("geometry/mesh")

    def file_of(self, written: str) -> Path | None:
        """Return the file that a `filename` names, or None if its package is unknown."""
        if written.startswith(SCHEMES):
            name, _, inside = written.partition("://")[2].lstrip("/").partition("/")
            return self.packages[name] / inside if name in self.packages else None
        if written.startswith(_FILE):
            written = written.removeprefix(_FILE)
        elif self.setting("strippath") == "true":
            written = written.replace("\\", "/").rpartition("/")[2]
        return Path(join(join(str(self.path.parent.absolute()), self.setting("meshdir") or ""), written))

    @staticmethod
    def advised(refused: Refused, written: str) -> Refused:
        """Return the refusal of a file with the advice for its name in the URDF.

        An absolute path is often that of another machine. A message does not say whether this machine has the file.
        """
        name = written.removeprefix(_FILE)
        if refused.help is None or not (written.startswith(_FILE) or is_absolute(name)):
            return refused
        help = f"write a path relative to the URDF, or `package://NAME/…`; {refused.help}"
        return Refused(refused.path, refused.why, help, refused.real)

    def simplified(self) -> None:
        """Rewrite file names as MuJoCo reads them: it knows only `package://`."""
        for mesh in self.root.iterfind("link/*/geometry/mesh"):
            written = str(mesh.get("filename") or "")
            name = written.removeprefix(_FILE)
            if written.startswith(SCHEMES):
                name = PACKAGE + written.partition("://")[2].lstrip("/")
            if name != written:
                mesh.set("filename", name)
                self.changed = True

    def text(self) -> str | None:
        """Return the text for MuJoCo, or None if it reads the file itself; the tree then has the lines of the text."""
        if not self.changed:
            return None
        etree.cleanup_namespaces(self.root)
        # A line for each element: MuJoCo reports only lines.
        text = etree.tostring(self.root, encoding="unicode", pretty_print=True)
        parser = etree.XMLParser(
            huge_tree=True,
            resolve_entities=False,
            no_network=True,
            remove_blank_text=True,
            recover=True,  # lxml may write prefixes that the file does not declare
        )
        new = etree.fromstring(text, parser)
        origins = Origins(texts=self.unit.origins.texts)
        for old, element in zip(self.root.iter("*"), new.iter("*"), strict=True):
            origins.own(element, partial(self.unit.origins.span, old, self.unit.file))
        self.unit.root = new
        self.unit.origins = origins
        return text

    def copied(self, element: Node) -> Node:
        """Insert a copy before an element, with its place."""
        new = copy.deepcopy(element)
        for old, each in zip(element.iter("*"), new.iter("*"), strict=True):
            owner = self.unit.origins.owner(old, self.unit.file)
            if owner is not self.unit.file:
                self.unit.origins.own(each, owner)
        element.addprevious(new)
        return new


def last_setting(root: Node, name: str) -> str | None:
    values = [each.get(name) for each in root.iterfind("mujoco/compiler") if each.get(name) is not None]
    return values[-1] if values else None


JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical")
_SHAPES = ("box", "cylinder", "sphere", "capsule")
_SIZES = "write a size greater than zero"
FLAT_HELP = "use a box, or a mesh with a thickness"
_ADVICE = {
    Topic.INERTIA: "correct it, or add `urdf: {inertia: repair}` next to `model`",
    Topic.MASS: "give the link an `<inertial>`, or add `urdf: {inertia: repair}` next to `model`",
    Topic.MESH_FORMAT: "convert it to STL, OBJ, MSH, Collada, glTF, PLY, OFF or 3MF",
    Topic.FLAT: FLAT_HELP,
    Topic.GEOM_SIZE: _SIZES,
    Topic.SIZE: _SIZES,
    Topic.URDF_GEOMETRY: "write a `<box>`, `<cylinder>`, `<sphere>`, `<capsule>` or `<mesh>` in `<geometry>`",
}
_ELSE = "MuJoCo must be able to load the file by itself: fix it there"
_OF_MESHES = (Topic.MESH_FORMAT, Topic.MESH_FILE, Topic.VERTICES, Topic.FLAT)
Place = Callable[[Node, str | None], Span]
"""The place of an element, or of one of its attributes."""


def explain(fault: EngineMessage, robot: Node, place: Place) -> Diagnostic:
    """Return MuJoCo's error about the URDF whose root is `robot`, in the words of URDF."""
    message = " ".join(fault.message.split())
    sentence = read_sentence(message)
    element = _element(fault, sentence, robot)
    known = None if sentence.topic is None else _KNOWN.get(sentence.topic)
    explained = None if known is None else known(element, robot, place)
    if explained is not None:
        return explained
    advice = None if sentence.topic is None else _ADVICE.get(sentence.topic)
    if sentence.missing_attribute is not None:
        advice = f'write `{sentence.missing_attribute}="…"`'
    elif sentence.missing_element is not None:
        advice = f"write `<{sentence.missing_element}>` in it"
    help = advice or translate(message, None).diagnostic.help or _ELSE
    attribute = sentence.attribute
    if element.tag == "mesh" and element.get("filename"):
        attribute = attribute or "filename"
    return _error(f"MuJoCo rejects the URDF: {message}", place(element, attribute), help)


def _error(message: str, span: Span, help: str, *notes: Note) -> Diagnostic:
    return Diagnostic("mujoco-rejects", message, span, notes=notes, help=help)


def named_in(message: str, robot: Node) -> Node:
    """Return the link or joint that a message names, or the robot if it names none."""
    elements = list(robot.iterchildren("joint", "link"))
    named = (each for name in read_sentence(message).names for each in elements if each.get("name") == name)
    return next(named, robot)


def _element(fault: EngineMessage, sentence: Sentence, robot: Node) -> Node:
    if sentence.topic in _OF_MESHES:
        for mesh in robot.iter("mesh"):
            file = str(mesh.get("filename") or "").replace("\\", "/").rpartition("/")[2]
            if file and {file, stem(file)} & {*sentence.names, fault.name}:
                return mesh
    if fault.line is not None:
        tags = (fault.element,) if fault.element else ("*",)
        return next((each for each in robot.iter(*tags) if (line_of(each) or 0) >= fault.line), robot)
    if fault.name:
        for each in robot.iter("link", "joint", "mesh", "visual", "collision"):
            name = stem(str(each.get("filename"))) if each.tag == "mesh" else each.get("name")
            if name == fault.name:
                return each
    return robot


def _repeated(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    for tag in ("link", "joint"):
        seen: dict[str | None, Node] = {}
        for each in robot.iterchildren(tag):
            name = each.get("name")
            if name is not None and seen.setdefault(name, each) is not each:
                note = Note(f"the other `{name}` is written here", place(seen[name], "name"))
                message = f"two {tag}s are called `{name}`"
                return _error(message, place(each, "name"), "rename one of them", note)
    return None


def _ring(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    """Find the ring: MuJoCo names only a link that it has reached."""
    joints = {child: joint for joint in robot.iterchildren("joint") if (child := end_of(joint, "child")) is not None}
    for start in joints:
        way = [start]
        above = end_of(joints[start], "parent")
        while above is not None and above in joints and above not in way:
            way.append(above)
            above = end_of(joints[above], "parent")
        if above in way:
            ring = way[way.index(above) :]
            links = ", whose parent is ".join(f"`{name}`" for name in [*ring, ring[0]])
            closing = ", ".join(f"`{joints[name].get('name')}`" for name in ring)
            help = f"remove {'one of the joints' if len(ring) > 1 else 'the joint'} {closing}"
            link = next((each for each in robot.iterchildren("link") if each.get("name") == ring[0]), element)
            return _error(f"links form a loop: {links}", place(link, "name"), help)
    return None


def _two_parents(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    name = end_of(element, "child")
    joints = [joint for joint in robot.iterchildren("joint") if end_of(joint, "child") == name]
    named = [f"`{joint.get('name')}`" for joint in joints]
    message = f"the link `{name}` is the child of several joints: {' and '.join(named)}"
    last = joints[-1]
    if end_of(last, "parent") == name:
        message = f"the joint {named[-1]} connects the link `{name}` to itself"
    note = Note(f"{named[0]} is written here", place(joints[0], "name"))
    help = f"remove {named[-1]}, or give it another child"
    return _error(message, place(next(last.iterchildren("child")), "link"), help, note)


def _mass(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    mass = element.find("inertial/mass") if element.tag == "link" else None
    if mass is None or not _is_none(str(mass.get("value"))):
        return None
    message = f"the moving link `{element.get('name')}` weighs {mass.get('value')} kg"
    return _error(message, place(mass, "value"), "write its mass")


def _no_link(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    links = [str(link.get("name")) for link in robot.iterchildren("link")]
    for end in element.iterchildren("parent", "child"):
        name = str(end.get("link"))
        if name not in links:
            help = did_you_mean(name, links) or "write the link, or remove the joint"
            note = exists_note("link", links, name)
            return _error(f"the link `{name}` does not exist", place(end, "link"), help, note)
    return None


def faulty_joints(robot: Node, place: Place) -> Iterator[Diagnostic]:
    """Yield an error for each joint with a link that does not exist, or of a type that URDF does not have."""
    for joint in robot.iterchildren("joint"):
        fault = _no_link(joint, robot, place)
        if fault is not None:
            yield fault
        if joint.get("type") is not None and joint.get("type") not in JOINT_TYPES:
            yield _joint_type(joint, robot, place)


def _joint_type(element: Node, robot: Node, place: Place) -> Diagnostic:
    word = str(element.get("type"))
    help = did_you_mean(word, JOINT_TYPES) or "write one of these types"
    note = exists_note("type", JOINT_TYPES, word)
    return _error(f"URDF has no joint of type `{word}`", place(element, "type"), help, note)


def _no_size(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    """Find the geom, which has no name: MuJoCo does not identify it."""
    keeps_visuals = last_setting(robot, "discardvisual") == "false"
    for each in robot.iterfind("link/*/geometry/*"):
        shape = next(each.iterancestors("collision", "visual"), None)
        if shape is None or each.tag not in _SHAPES or (shape.tag == "visual" and not keeps_visuals):
            continue
        for name in ("size", "radius", "length"):
            if any(map(_is_none, str(each.get(name) or "").split())):
                return _error(f"`{name}` of `<{each.tag}>` must be positive", place(each, name), _SIZES)
    return None


def _is_none(number: str) -> bool:
    try:
        return float(number) <= 0
    except ValueError:
        return False


def end_of(joint: Node, tag: str) -> str | None:
    end = joint.find(tag)
    return None if end is None else end.get("link")


_KNOWN: Mapping[Topic, Callable[[Node, Node, Place], Diagnostic | None]] = {
    Topic.URDF_REPEATED: _repeated,
    Topic.URDF_RING: _ring,
    Topic.URDF_PARENTS: _two_parents,
    Topic.URDF_LINK: _no_link,
    Topic.URDF_JOINT_TYPE: _joint_type,
    Topic.MASS: _mass,
    Topic.GEOM_SIZE: _no_size,
    Topic.SIZE: _no_size,
}
"""Functions that find the element of a sentence, and report it in the words of URDF."""
