"""The meaning of keys, noted where they are read and written, without any layout.

`Bare` is a model with little more than its joints, actuators and mocap bodies. MuJoCo compiles it in a moment, with
the same names and addresses as the whole model, so that it says what each number of a key is of. `KeyNotes` has the
bare source of every key, and what the recipes write and edit: `verify/kept_keys.py` compares the finished keys with it.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import field

from lxml.etree import _Element as Node
from lxml.etree import tostring

from composer.dataclass import dataclass
from composer.link.key_layouts import VECTORS, keys_of
from composer.link.key_table import Written
from composer.link.linking import Linking
from composer.link.multiplied import ends_of_copies
from composer.numerics.pose import Pose
from composer.tree.settings import read_settings
from composer.tree.unit import Unit

Within = frozenset[tuple[Node, int]]
"""The number of a copy in each `<replicate>` around it."""
Holder = tuple[Node, Within, str]
"""A joint, actuator or mocap body as MuJoCo makes it: its element, which copy, and what a `<flexcomp>` calls it."""

MARK = "\u00b7"
"""The first letter of the names that bare models give to what has none."""
# Models that MuJoCo attaches itself, and shapes that it reads from files, are more than a tree.
_BEYOND = ("attach", "composite")
_POSES = ("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")
_KEPT: Mapping[str, tuple[str, ...] | None] = {
    "body": ("name", "mocap", "childclass", *_POSES),
    "frame": ("childclass", *_POSES),
    "replicate": None,
    "joint": ("name", "class", "type", "pos", "axis", "ref", "range", "limited"),
    "freejoint": ("name",),
    "site": ("name",),
}
# They limit or tune, and may name what is not there.
_LEFT_OUT = ("user", "group", "inheritrange", "ctrllimited", "dampratio", "material", "class")
_INERTIA = {"pos": "0 0 0", "mass": "1", "diaginertia": "1 1 1"}


@dataclass(eq=False, slots=True)
class Bare:
    """A model as text, with the element of each name in it. `rows` has the length of each row of each key.

    `moves` are the poses of the parts that it has become part of, innermost first; `file` is its name in messages.
    """

    file: str
    text: str
    named: dict[tuple[str, str], tuple[Node, Within]]
    flexes: dict[str, tuple[Node, dict[str, Within]]]
    rows: dict[Node, dict[str, int]]
    moves: list[Pose] = field(default_factory=list)

    def holder(self, kind: str, name: str, body: str) -> Holder | None:
        """Return whose a joint or another element of the compiled model is; `body` is the name of its body."""
        found = self.named.get((kind, name))
        if found is not None:
            return *found, ""
        # `rod_3` and `rod_twist_0` are of `<flexcomp name="rod">`. The first is `rod_30` and `rod_31` in a replicate.
        for flex in (body[:at] for at, letter in enumerate(body) if letter == "_"):
            if flex in self.flexes:
                node, ends = self.flexes[flex]
                for end, within in ends.items() if not name and ends else ():
                    if body.endswith(end):
                        return node, within, body[len(flex) : len(body) - len(end)]
                return node, frozenset(), body[len(flex) :]
        return None


@dataclass(eq=False, slots=True)
class KeyNotes:
    """Notes about the keys of a composition.

    `sources` has the bare models by the root of the tree that they are in; `written` the keys of recipes; `edited`
    those with numbers that edits or draws change; `copied` the elements that a replicate which is written out
    becomes, each with its origin.
    """

    sources: dict[Node, list[Bare]] = field(default_factory=dict)
    written: dict[Node, Written] = field(default_factory=dict)
    edited: set[Node] = field(default_factory=set)
    copied: dict[Node, tuple[Node, tuple[Node, int]]] = field(default_factory=dict)

    def read(self, unit: Unit) -> None:
        """Note what the keys of a source mean, as it is in its file."""
        if keys_of(unit) and (found := bare(unit)) is not None:
            self.sources[unit.root] = [found]

    def join(self, linking: Linking) -> None:
        """Note that the parts have become part of the base, where their places move what is in the world."""
        joined = self.sources.setdefault(linking.base.root, [])
        for part in linking.parts:
            found = self.sources.pop(part.unit.root, [])
            if part.pose_in_world is not None:
                for each in found:
                    each.moves.append(part.pose_in_world)
            joined += found
        self.copied |= linking.notes.copied

    def add(self, linking: Linking) -> None:
        """Note what a recipe has written into keys, and has edited in them."""
        self.written |= linking.keys.noted
        self.edited |= linking.keys.edited_keys
        self.copied |= linking.notes.copied

    def origin(self, node: Node, within: Within) -> tuple[Node, Within]:
        """Return the element that a node is a copy of, and which copy."""
        while node in self.copied:
            node, number = self.copied[node]
            within |= {number}
        return node, within


def bare(unit: Unit) -> Bare | None:
    """Return the bare model of a unit, or None if MuJoCo needs more than the tree."""
    root = unit.root
    if next(root.iter(*_BEYOND), None) is not None:
        return None
    flexes = list(root.iter("flexcomp"))
    if any(flex.get("file") or flex.get("mesh") for flex in flexes):
        return None
    found = Bare(
        unit.file, "", {}, {str(flex.get("name") or ""): (flex, _copies(flex)) for flex in flexes}, {}
    )
    made = root.makeelement("mujoco")
    # The last one counts.
    settings = read_settings(root)
    compiler = made.makeelement("compiler", {"angle": settings.angle, "eulerseq": settings.eulerseq})
    compiler.append(compiler.makeelement("lengthrange", {"mode": "none"}))
    made.append(compiler)
    for section in root.iterchildren("extension", "default", "worldbody", "tendon", "actuator"):
        _SECTIONS[str(section.tag)](section, made, found)
    keyframe = made.makeelement("keyframe")
    for key in keys_of(unit):
        rows = {vector: str(key.get(vector)) for vector in VECTORS if key.get(vector)}
        keyframe.append(keyframe.makeelement("key", rows))
        found.rows[key] = {vector: len(row.split()) for vector, row in rows.items()}
    made.append(keyframe)
    found.text = tostring(made, encoding="unicode")
    return found


def _extension(section: Node, made: Node, found: Bare) -> None:
    made.append(copy.copy(section))


def _default(section: Node, made: Node, found: Bare) -> None:
    own = _only(section, made, ("class",))
    for child in section.iterchildren("*"):
        if child.tag == "default":
            _default(child, own, found)
        elif child.tag == "joint":
            own.append(_only(child, own, _KEPT["joint"]))
        elif child.tag in _ACTUATORS:
            own.append(_actuator(child, own))
    made.append(own)


def _worldbody(section: Node, made: Node, found: Bare) -> None:
    # Spatial tendons wrap around them.
    tree = section.getroottree().getroot()
    wrapped = {str(each.get("geom")) for each in tree.iterfind("tendon/spatial/geom")}
    own = made.makeelement("worldbody")
    _tree(section, own, found, wrapped, ())
    made.append(own)


def _tree(source: Node, made: Node, found: Bare, wrapped: set[str], around: tuple[Node, ...]) -> None:
    """Copy what is in a body. `around` are the replicates around it, innermost first."""
    if made.tag == "body":
        made.append(made.makeelement("inertial", _INERTIA))
    for child in source.iterchildren("*"):
        tag = str(child.tag)
        if tag in _KEPT:
            own = _only(child, made, _KEPT[tag])
            if tag in ("body", "joint", "freejoint"):
                _name(child, own, "joint" if tag == "freejoint" else tag, found, around)
            made.append(own)
            if tag in ("body", "frame", "replicate"):
                _tree(child, own, found, wrapped, (child, *around) if tag == "replicate" else around)
        elif tag == "flexcomp":
            own = copy.copy(child)
            own.tail = None
            for attribute in ("material", "class"):
                own.attrib.pop(attribute, "")
            for plugin in list(own.iterchildren("plugin")):
                own.remove(plugin)
            made.append(own)
        elif tag == "geom" and child.get("name") in wrapped:
            made.append(
                made.makeelement(
                    "geom", {"name": str(child.get("name")), "type": "sphere", "size": ".01", "mass": "0"}
                )
            )


def _tendon(section: Node, made: Node, found: Bare) -> None:
    own = made.makeelement("tendon")
    for tendon in section.iterchildren("*"):
        each = _only(tendon, own, ("name",))
        each.extend(copy.copy(child) for child in tendon.iterchildren("*"))
        own.append(each)
    made.append(own)


def _actuators(section: Node, made: Node, found: Bare) -> None:
    # Those that act on something in a replicate are multiplied with it, also by a tendon.
    tree = section.getroottree().getroot()
    multiplied: dict[str, list[Node]] = {}
    for each in tree.iterfind("worldbody//replicate//*[@name]"):
        multiplied.setdefault(str(each.get("name")), list(each.iterancestors("replicate")))
    for tendon in tree.iterfind("tendon/*[@name]") if multiplied else ():
        ends = (str(value) for each in tendon.iter("*") for value in each.attrib.values())
        if around := next((multiplied[end] for end in ends if end in multiplied), None):
            multiplied.setdefault(str(tendon.get("name")), around)
    own = made.makeelement("actuator")
    for actuator in section.iterchildren("*"):
        each = _actuator(actuator, own)
        if actuator.get("class"):
            each.set("class", str(actuator.get("class")))
        _name(actuator, each, "actuator", found, ())
        acted = (str(value) for name, value in actuator.attrib.items() if name not in ("name", "class"))
        if around := next((multiplied[end] for end in acted if end in multiplied), None):
            _note_copies(actuator, str(each.get("name")), "actuator", found, tuple(around))
        own.append(each)
    made.append(own)


def _actuator(actuator: Node, made: Node) -> Node:
    own = copy.copy(actuator)
    own.tail = None
    for attribute in _LEFT_OUT:
        own.attrib.pop(attribute, "")
    return own


_SECTIONS = {
    "extension": _extension,
    "default": _default,
    "worldbody": _worldbody,
    "tendon": _tendon,
    "actuator": _actuators,
}
_ACTUATORS = frozenset(
    "general motor position velocity intvelocity damper cylinder muscle adhesion dcmotor pid orientation plugin".split()
)


def _only(source: Node, made: Node, names: tuple[str, ...] | None) -> Node:
    """Return an element with only these attributes of another one, or with all of them."""
    attributes = {
        str(name): str(value) for name, value in source.attrib.items() if names is None or str(name) in names
    }
    return made.makeelement(str(source.tag), attributes)


def _name(source: Node, made: Node, kind: str, found: Bare, around: tuple[Node, ...]) -> None:
    """Note the names that MuJoCo gives to the copies of an element, after giving it one if it has none."""
    name = str(source.get("name") or f"{MARK}{len(found.named)}{MARK}")
    made.set("name", name)
    found.named.setdefault((kind, name), (source, frozenset()))
    _note_copies(source, name, kind, found, around)


def _note_copies(source: Node, name: str, kind: str, found: Bare, around: tuple[Node, ...]) -> None:
    for end, within in ends_of_copies(around).items():
        found.named.setdefault((kind, name + end), (source, frozenset(within)))


def _copies(element: Node) -> dict[str, Within]:
    ends = ends_of_copies(list(element.iterancestors("replicate")))
    return {end: frozenset(within) for end, within in ends.items()}
