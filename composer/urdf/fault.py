"""Report MuJoCo's errors about a URDF file at the element that causes them, with advice for its author."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.mujoco_errors.message import Fault
from composer.mujoco_errors.sentence import Sentence, Topic, read_sentence
from composer.mujoco_errors.translation import translate
from composer.tree.files import stem
from composer.tree.line import line_of

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical")
_SHAPES = ("box", "cylinder", "sphere", "capsule")
_SIZES = "sizes are greater than zero"
FLAT_HELP = "use a box, or a mesh with a thickness"
_ADVICE = {
    Topic.INERTIA: "correct it, or write beside `model`: `urdf: {inertia: mend}`",
    Topic.MASS: "give the link an `<inertial>`, or write beside `model`: `urdf: {inertia: mend}`",
    Topic.MESH_FORMAT: "convert it to STL, OBJ, MSH, Collada, glTF, PLY, OFF or 3MF, which are read",
    Topic.FLAT: FLAT_HELP,
    Topic.GEOM_SIZE: _SIZES,
    Topic.SIZE: _SIZES,
    Topic.URDF_GEOMETRY: "write a `<box>`, `<cylinder>`, `<sphere>`, `<capsule>` or `<mesh>` in `<geometry>`",
}
_ELSE = "MuJoCo must be able to load the file by itself: fix it there"


_OF_MESHES = (Topic.MESH_FORMAT, Topic.MESH_FILE, Topic.VERTICES, Topic.FLAT)
Place = Callable[[Node, str | None], Span]
"""The place of an element, or of one of its attributes."""


def explain(fault: Fault, robot: Node, place: Place) -> Diagnostic:
    """The error where MuJoCo refuses the URDF whose root is `robot`, in the words of its author."""
    said = " ".join(fault.message.split())
    sentence = read_sentence(said)
    element = _element(fault, sentence, robot)
    known = None if sentence.topic is None else _KNOWN.get(sentence.topic)
    if known is not None and (found := known(element, robot, place)) is not None:
        return found
    advice = None if sentence.topic is None else _ADVICE.get(sentence.topic)
    if sentence.missing_attribute is not None:
        advice = f'write `{sentence.missing_attribute}="…"`'
    elif sentence.missing_element is not None:
        advice = f"write `<{sentence.missing_element}>` in it"
    help = advice or translate(said, None).diagnostic.help or _ELSE
    attribute = sentence.attribute
    if element.tag == "mesh" and element.get("filename"):
        attribute = attribute or "filename"
    return _error(f"MuJoCo rejects the URDF: {said}", place(element, attribute), help)


def _error(message: str, span: Span, help: str, *notes: Note) -> Diagnostic:
    return Diagnostic("mujoco-rejects", message, span, notes=notes, help=help)


def named_in(said: str, robot: Node) -> Node:
    """The link or joint that a message names; the robot where it names none."""
    for name in read_sentence(said).names:
        for each in robot.iterchildren("joint", "link"):
            if each.get("name") == name:
                return each
    return robot


def _element(fault: Fault, sentence: Sentence, robot: Node) -> Node:
    """The element that MuJoCo speaks of, by its line or by its name."""
    for mesh in robot.iter("mesh") if sentence.topic in _OF_MESHES else ():
        file = str(mesh.get("filename") or "").replace("\\", "/").rpartition("/")[2]
        if file and {file, stem(file)} & {*sentence.names, fault.name}:
            return mesh
    if fault.line is not None:
        tags = (fault.element,) if fault.element else ("*",)
        after = (each for each in robot.iter(*tags) if (line_of(each) or 0) >= fault.line)
        return next(after, robot)
    for each in robot.iter("link", "joint", "mesh", "visual", "collision") if fault.name else ():
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
                return _error(message, place(each, "name"), "give one of them another name", note)
    return None


def _ring(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    """MuJoCo starts from the links that have no parent, and names one of those that it has reached."""
    joints = {
        child: joint for joint in robot.iterchildren("joint") if (child := _end(joint, "child")) is not None
    }
    for start in joints:
        way, above = [start], _end(joints[start], "parent")
        while above is not None and above in joints and above not in way:
            way.append(above)
            above = _end(joints[above], "parent")
        if above in way:
            ring = way[way.index(above) :]
            links = ", whose parent is ".join(f"`{name}`" for name in [*ring, ring[0]])
            closing = ", ".join(f"`{joints[name].get('name')}`" for name in ring)
            one = f"one of the joints {closing}" if len(ring) > 1 else f"the joint {closing}"
            help = f"one of them must have no parent: remove {one}"
            link = next((each for each in robot.iterchildren("link") if each.get("name") == ring[0]), element)
            return _error(f"links are in a ring: {links}", place(link, "name"), help)
    return None


def _two_parents(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    name = _end(element, "child")
    joints = [joint for joint in robot.iterchildren("joint") if _end(joint, "child") == name]
    named = [f"`{joint.get('name')}`" for joint in joints]
    message = f"the link `{name}` is the child of several joints: {' and '.join(named)}"
    last = joints[-1]
    if _end(last, "parent") == name:
        message = f"the joint {named[-1]} connects the link `{name}` with itself"
    note = Note(f"{named[0]} is written here", place(joints[0], "name"))
    child = next(last.iterchildren("child"))
    help = f"a link is the child of one joint at most: remove {named[-1]}, or give it another child"
    return _error(message, place(child, "link"), help, note)


def _mass(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    """A mass that is written, and that nothing can have."""
    mass = element.find("inertial/mass") if element.tag == "link" else None
    if mass is None or not _is_none(str(mass.get("value"))):
        return None
    message = f"the link `{element.get('name')}` weighs {mass.get('value')} kg, and moves"
    return _error(message, place(mass, "value"), "write what it weighs")


def _no_link(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    links = [str(link.get("name")) for link in robot.iterchildren("link")]
    for end in element.iterchildren("parent", "child"):
        name = str(end.get("link"))
        if name not in links:
            help = did_you_mean(name, links) or "write the link, or take the joint out"
            note = exists_note("link", links, name)
            return _error(f"the link `{name}` does not exist", place(end, "link"), help, note)
    return None


def _joint_type(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    word = str(element.get("type"))
    help = did_you_mean(word, JOINT_TYPES) or "write one of these types"
    note = exists_note("type", JOINT_TYPES, word)
    return _error(f"URDF has no joint of type `{word}`", place(element, "type"), help, note)


def _no_size(element: Node, robot: Node, place: Place) -> Diagnostic | None:
    """MuJoCo does not say which: geoms have no names there. It reads visuals where the file says so."""
    kept = [each.get("discardvisual") for each in robot.iterfind("mujoco/compiler")]
    keeps_visuals = [each for each in kept if each is not None][-1:] == ["false"]
    for each in robot.iterfind("link/*/geometry/*"):
        shape = each.iterancestors("collision", "visual")
        if each.tag not in _SHAPES or (next(shape).tag == "visual" and not keeps_visuals):
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


def _end(joint: Node, tag: str) -> str | None:
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
"""What finds the element that a sentence is about, and says it in the words of URDF."""
