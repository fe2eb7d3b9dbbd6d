"""The layout of a key's numbers: joints depth first, actuators and mocap bodies in order.

MuJoCo lays out `qpos` body by body, depth first in document order, a body's joints before its children; frames do not
count. A `<replicate>` is laid out copy by copy. An element that only MuJoCo expands (`flexcomp`, `attach`) is one
block. The joints in which a rod is twisted are another. `test_key_layout.py` compares all of this with MuJoCo.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from functools import cached_property
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.link import numbers
from mjcompose.link.expansion import Copy, Within, actuators_in_order, copies_of, element_of
from mjcompose.mujoco.arrays import JOINT_TYPES
from mjcompose.tree.classes import Classes, childclass_of, through_frames
from mjcompose.tree.grammar import NotMjcf
from mjcompose.tree.unit import Unit


def joints_in_order(unit: Unit) -> list[Holder]:
    """Return the joints of a model in the order of `qpos`, and the blocks that MuJoCo expands. It measures nothing."""
    layout = KeyLayout()
    block = Slot(BLOCK, (0, 0))
    reader = _Reader(unit, dict.fromkeys(unit.root.iter(*BLOCKS), block))
    for worldbody in unit.root.iterchildren("worldbody"):
        reader.visit_world(worldbody, layout)
    return list(layout.joints)


JOINTS = ("joint", "freejoint")
BLOCKS = ("flexcomp", "composite", "attach")
# Actuators with one control and, by tag, this many activations; the others only MuJoCo knows.
_ACTIVATIONS = {"motor": 0, "velocity": 0, "damper": 0, "adhesion": 0, "intvelocity": 1, "cylinder": 1, "muscle": 1}

Holder = Node | Copy
"""A holder of numbers of a key: an element, or one of the copies that MuJoCo makes of it."""


class Unknown(Exception):
    """Raised for a width that only MuJoCo knows; `element` is the element that has it."""

    def __init__(self, element: Node) -> None:
        super().__init__(str(element.tag))
        self.element = element


class Slot(NamedTuple):
    """The widths of a joint, an actuator or a block: the count of its numbers in each vector of a key.

    `free` has the offsets in `qpos` and `qvel` of each free joint. `twists` is the number of joints in which a rod is
    twisted; `widths` does not count them. `controls` and the fields after it are for a model that MuJoCo attaches: the
    total widths of its actuators, and its numbers of actuators, mocap bodies and keys.
    """

    kind: str
    widths: tuple[int, int]
    free: tuple[tuple[int, int], ...] = ()
    twists: int = 0
    controls: tuple[int, int] = (0, 0)
    actuators: int = 0
    mocaps: int = 0
    keys: int = 0


BLOCK = "block"
_JOINTS = {
    each.word: Slot(each.word, (each.positions, each.velocities), ((0, 0),) if each.word == "free" else ())
    for each in JOINT_TYPES
}


def actuator_slot(activations: int, controls: int = 1) -> Slot:
    return Slot("actuator", (controls, activations))


_ACTUATORS = {tag: actuator_slot(activations) for tag, activations in _ACTIVATIONS.items()}
_STATELESS = actuator_slot(0)


class KeyLayout(Struct, frozen=False):
    """The elements of a model in the order of their numbers in a key.

    The widths of `joints` are (nq, nv), and the widths of `actuators` are (nctrl, nact). `mocaps` has the number of
    mocap bodies of each element: one for a body, any number for a model that MuJoCo attaches.
    """

    joints: dict[Holder, Slot] = field(default_factory=dict)
    actuators: dict[Holder, Slot] = field(default_factory=dict)
    mocaps: dict[Holder, int] = field(default_factory=dict)

    @property
    def in_world_coordinates(self) -> bool:
        """Whether a key has poses in the world, which belong to free joints and mocap bodies."""
        return bool(self.mocaps) or any(slot.free for slot in self.joints.values())

    def holders(self, vector: str) -> list[tuple[Holder, int]]:
        if vector in ("qpos", "qvel"):
            return [(joint, slot.widths[vector == "qvel"]) for joint, slot in self.joints.items()]
        if vector in ("ctrl", "act"):
            return [(actuator, slot.widths[vector == "act"]) for actuator, slot in self.actuators.items()]
        return [(body, count * (3 if vector == "mpos" else 4)) for body, count in self.mocaps.items()]

    def total(self, vector: str) -> int:
        return sum([width for _, width in self.holders(vector)])

    def free(self) -> Iterator[tuple[int, int]]:
        """Yield the indices in `qpos` and `qvel` at which the numbers of each free joint begin."""
        nq = nv = 0
        for slot in self.joints.values():
            yield from ((nq + q, nv + v) for q, v in slot.free)
            nq = nq + slot.widths[0]
            nv = nv + slot.widths[1]


# An actuator may have several controls since MuJoCo 4.0: `<pid joint="j" kp="1"/>` alone has `nactuator` 1 and `nu` 2,
# and with `ki` and `slewmax` `na` 2.
_STATE = {"position": {"timeconst"}, "general": {"dyntype", "actdim", "input"}}
_OF_GENERAL = ("gaintype", "dyntype", "actdim", "input")
_SEVERAL = ("pid", "so3", "dcmotor")  # kinds of gain and dynamics that say how many inputs there are
_STATEFUL = ("intvelocity", "cylinder", "muscle", "dcmotor", "pid", "orientation")


def lay_out(unit: Unit, known: Mapping[Node, Slot]) -> KeyLayout:
    """Return the layout of a whole model. Raises `Unknown` for a width that neither the tree nor `known` gives."""
    layout = KeyLayout()
    reader = _Reader(unit, known)
    for worldbody in unit.root.iterchildren("worldbody"):
        joints = _plain_joints(worldbody)
        if joints is None:
            reader.visit_world(worldbody, layout)
        else:
            layout.joints.update([(joint, known.get(joint) or reader.joint(joint)) for joint in joints])
        # Only a child of the world is a mocap body, even through a frame or a replicate. For a deeper body MuJoCo 4.0
        # says "not a fixed child of world".
        layout.mocaps.update(reader.mocaps(worldbody, ()))
    layout.actuators = {
        holder: known.get(each := element_of(holder)) or reader.actuator(each)
        for holder in actuators_in_order(unit.root)
    }
    # MuJoCo attaches models after it has read everything.
    for block, slot in layout.joints.items():
        if slot.controls != (0, 0):
            if isinstance(block, Copy):  # the order in which MuJoCo multiplies its actuators is not known
                raise Unknown(block.element)
            layout.actuators[block] = Slot("actuator", slot.controls)
    return layout


def _plain_joints(worldbody: Node) -> list[Node] | None:
    """Return the joints if they are in the order of their bodies and no other element matters, else None."""
    # The joints of a body come before its children's joints, wherever they are written: in MuJoCo 4.0
    # `<body><body><joint name="in"/>…</body><joint name="out"/></body>` has `out` first.
    joints: list[Node] = []
    body = worldbody
    for element in worldbody.iter("body", *JOINTS, "replicate", *BLOCKS):
        tag = element.tag
        if tag == "body":
            body = element
        elif tag in JOINTS and element.getparent() is body:
            joints.append(element)
        else:  # a replicate, a block, or a joint in a frame or after a child of its body
            return None
    return joints


class _Reader:
    """Reads the widths of elements that are not known yet; looks at default classes only if they may matter."""

    def __init__(self, unit: Unit, known: Mapping[Node, Slot]) -> None:
        self.unit = unit
        self.known = known
        self._said: dict[str, tuple[str | None, ...] | None] = {}

    @cached_property
    def influence(self) -> tuple[bool, bool]:
        """Whether a class sets a joint type other than hinge, and whether a class gives actuators a state or inputs."""
        typed = stateful = False
        for section in self.unit.root.iterchildren("default"):
            for element in section.iter("joint", "position", "general", *_STATEFUL):
                tag = element.tag
                if tag == "joint":
                    typed = typed or element.get("type") not in (None, "hinge")
                elif not stateful:
                    stateful = (
                        tag not in _STATE
                        or not _STATE[tag].isdisjoint(element.keys())
                        or element.get("gaintype") in _SEVERAL
                    )
        return typed, stateful

    def visit_world(self, worldbody: Node, layout: KeyLayout) -> None:
        """Lay out the bodies of the world, each followed by the twists of the rods in it."""
        # MuJoCo 4.0 puts the bodies that a rod is twisted in last into the world, as it reads the rod: `<body
        # name="a"><flexcomp name="rod" …/><body name="b"/></body><body name="c"/>` becomes a, rod_0, …, b, rod_twist_0,
        # …, rod_twist, c. The content of a `<replicate>` of the world is in the world only when MuJoCo has read all of
        # it, so they come first there. Either way there is one set of them, not one for each copy.
        for child in through_frames(worldbody):
            inside = KeyLayout()
            twists = KeyLayout()
            self._inner(child, (), inside, twists=twists)
            first, second = (twists, inside) if child.tag == "replicate" else (inside, twists)
            layout.joints |= first.joints
            layout.joints |= second.joints

    def visit(self, body: Node, within: Within, layout: KeyLayout, twists: KeyLayout) -> None:
        """Lay out a body's joints, then the elements inside it."""
        inner: list[Node] = []
        for child in through_frames(body):
            if child.tag in JOINTS:
                layout.joints[_copy(child, within)] = self.known.get(child) or self.joint(child)
            elif child.tag in ("body", "replicate", *BLOCKS):
                inner.append(child)
        # A body's own joints come before its children's joints, even if they are written later: in MuJoCo 4.0
        # `<body><body><joint name="inner"/></body><joint name="outer"/></body>` has `outer` at qpos 0.
        for child in inner:
            self._inner(child, within, layout, twists=twists)

    def _inner(self, child: Node, within: Within, layout: KeyLayout, twists: KeyLayout) -> None:
        if child.tag == "body":
            self.visit(child, within, layout, twists=twists)
        elif child.tag == "replicate":
            for number in range(copies_of(child)):
                self.visit(child, ((child, number), *within), layout, twists=twists)
        elif child.tag in BLOCKS:
            slot = self.known.get(child)
            if slot is None:
                raise Unknown(child)
            layout.joints[_copy(child, within)] = slot
            if slot.twists:
                twists.joints[Copy(child, twists=True)] = Slot(BLOCK, (slot.twists, slot.twists))

    def joint(self, joint: Node) -> Slot:
        if self.influence[0]:
            kind = joint_type(joint, self.unit.classes)
        else:
            kind = "free" if joint.tag == "freejoint" else joint.get("type") or "hinge"
        slot = _JOINTS.get(kind)
        if slot is None:
            raise NotMjcf(f"no type of a joint: {kind}")
        return slot

    def mocaps(self, holder: Node, within: Within) -> Iterator[tuple[Holder, int]]:
        """Yield the mocap bodies directly in the world, or in a replicate there, and the elements that contain some."""
        for child in through_frames(holder):
            if child.tag == "replicate":
                for number in range(copies_of(child)):
                    yield from self.mocaps(child, ((child, number), *within))
            elif child.tag == "attach" and (count := self.known[child].mocaps):
                yield _copy(child, within), count
            elif child.tag == "body" and child.get("mocap") == "true":
                yield _copy(child, within), 1

    def actuator(self, actuator: Node) -> Slot:
        tag = actuator.tag
        known = _ACTUATORS.get(tag)
        if known is not None:
            return known
        if tag == "position":
            if actuator.get("timeconst") is None and not (self.influence[1] and self._inherits_state(actuator)):
                return _STATELESS
        elif tag == "general" and (slot := self._general(actuator)) is not None:
            return slot
        raise Unknown(actuator)

    def _inherits_state(self, position: Node) -> bool:
        """Return whether its class may set activations or inputs: in MuJoCo, all actuator tags share one struct."""
        found = self.unit.classes.get(str(position.get("class") or "") or None)
        return bool(
            any(found.lookup("general", name) for name in _STATE["general"])
            or (found.lookup("general", "gaintype") or ("",))[0] in _SEVERAL
            or found.lookup("position", "timeconst")
            or any(map(found.sets, _STATEFUL))
        )

    def _general(self, general: Node) -> Slot | None:
        """Return the slot of a `<general>` from its own and its class's settings, or None if they are not enough."""
        gain, dyntype, size, inputs = map(general.get, _OF_GENERAL)
        if self.influence[1]:
            said = self._said_of_general(str(general.get("class") or ""))
            if said is None:
                return None
            gain = gain or said[0]
            dyntype = dyntype or said[1]
            size = size or said[2]
            inputs = inputs or said[3]
        if gain in _SEVERAL or dyntype in _SEVERAL or inputs:
            return None
        if not size or numbers.integer(size) < 0:  # the default of MuJoCo
            return _STATELESS if dyntype in (None, "none") else actuator_slot(1)
        return actuator_slot(numbers.integer(size))

    def _said_of_general(self, name: str) -> tuple[str | None, ...] | None:
        """Return the `_OF_GENERAL` settings of a class for a `<general>`, or None if its other tags affect them too."""
        if name not in self._said:
            found = self.unit.classes.get(name or None)
            given = [found.lookup("general", each) for each in _OF_GENERAL]
            mixed = any(map(found.sets, (*_STATEFUL, "position")))
            self._said[name] = None if mixed else tuple(each and each[0] for each in given)
        return self._said[name]


def _copy(element: Node, within: Within) -> Holder:
    return Copy(element, within) if within else element


def joint_type(joint: Node, classes: Classes) -> str:
    if joint.tag == "freejoint":
        return "free"
    return classes.effective(joint, childclass_of(joint), "type") or "hinge"
