"""How the numbers of a keyframe are laid out: joints depth first, actuators and mocap bodies in order.

MuJoCo lays out `qpos` body by body, depth first in document order, a body's joints before its children; frames do
not count. What MuJoCo expands (`replicate`, `flexcomp`) is one block here: nothing hangs inside it, so that its inner
order cannot change.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.tree.classes import Classes, DefaultClass, childclass_of, through_frames
from composer.tree.unit import Unit

_WIDTHS = {"free": (7, 6), "ball": (4, 3), "slide": (1, 1), "hinge": (1, 1)}
_BLOCKS = ("replicate", "flexcomp", "composite", "attach")
# Actuators with one control and, by tag, this many activations; the others only MuJoCo can tell.
_ACTIVATIONS = {
    "motor": 0,
    "velocity": 0,
    "damper": 0,
    "adhesion": 0,
    "intvelocity": 1,
    "cylinder": 1,
    "muscle": 1,
}


class Unknown(Exception):
    """A width that only MuJoCo can tell; `element` is where."""

    def __init__(self, element: Node) -> None:
        super().__init__(str(element.tag))
        self.element = element


class Slot(NamedTuple):
    """One joint, actuator or mocap body (or block of them) and how many numbers it has in each vector of a key."""

    element: Node
    kind: str
    widths: tuple[int, ...]


@dataclass(slots=True)
class Layout:
    """`joints`: (nq, nv) each; `actuators`: (nctrl, nact) each; `mocaps`: bodies."""

    joints: list[Slot] = field(default_factory=list)
    actuators: list[Slot] = field(default_factory=list)
    mocaps: list[Node] = field(default_factory=list)

    @property
    def in_world_coordinates(self) -> bool:
        """Whether a key holds poses in the world: of free joints or mocap bodies."""
        return bool(self.mocaps) or any(slot.kind == "free" for slot in self.joints)

    def total(self, vector: str) -> int:
        if vector in ("qpos", "qvel"):
            return sum(slot.widths[vector == "qvel"] for slot in self.joints)
        if vector in ("ctrl", "act"):
            return sum(slot.widths[vector == "act"] for slot in self.actuators)
        return len(self.mocaps) * (3 if vector == "mpos" else 4)


_STATEFUL = ("intvelocity", "cylinder", "muscle", "dcmotor", "pid", "orientation")


def lay_out(unit: Unit, known: Mapping[Node, tuple[int, ...] | Slot]) -> Layout:
    """The layout of a whole model; raises `Unknown` for what neither the tree nor `known` tells."""
    layout = Layout()
    root = unit.root
    reader = _Reader(unit, known, *_class_influence(root))
    for worldbody in root.iterchildren("worldbody"):
        found = list(worldbody.iter("joint", "freejoint", *_BLOCKS))
        if any(element.tag in _BLOCKS or _is_late(element) for element in found):
            reader.visit(worldbody, layout)
        else:  # joints stand in the order of their bodies: nothing else needs to be looked at
            layout.joints.extend(map(reader.joint, found))
        layout.mocaps.extend(
            body for body in through_frames(worldbody) if body.tag == "body" and body.get("mocap") == "true"
        )
    for section in root.iterchildren("actuator"):
        layout.actuators.extend(map(reader.actuator, section.iterchildren("*")))
    return layout


def _is_late(joint: Node) -> bool:
    """Whether it is written after a child of its body, or in a frame that is."""
    return next(joint.itersiblings("body", "frame", preceding=True), None) is not None


def _class_influence(root: Node) -> tuple[bool, bool]:
    """Whether any class types joints, and whether any gives actuators a state or inputs."""
    typed = stateful = False
    for section in root.iterchildren("default"):
        for element in section.iter("joint", "position", "general", *_STATEFUL):
            tag = element.tag
            if tag == "joint":
                typed = typed or element.get("type") is not None
            elif tag == "position":
                stateful = stateful or element.get("timeconst") is not None
            elif tag != "general" or any(element.get(name) for name in ("dyntype", "actdim", "input")):
                stateful = True
    return typed, stateful


@dataclass(frozen=True, slots=True)
class _Reader:
    unit: Unit
    known: Mapping[Node, tuple[int, ...] | Slot]
    typed: bool
    stateful: bool

    def visit(self, body: Node, layout: Layout) -> None:
        """A body's joints, then what is inside it."""
        inner: list[Node] = []
        for child in through_frames(body):
            if child.tag in ("joint", "freejoint"):
                layout.joints.append(self.joint(child))
            elif child.tag == "body" or child.tag in _BLOCKS:
                inner.append(child)
        for child in inner:
            if child.tag == "body":
                self.visit(child, layout)
            else:
                layout.joints.append(self.block(child))

    def joint(self, joint: Node) -> Slot:
        known = self.known.get(joint)
        if isinstance(known, Slot):
            return known
        kind = joint_type(joint, self.unit.classes) if self.typed else _own_type(joint)
        return Slot(joint, kind, _WIDTHS[kind])

    def block(self, block: Node) -> Slot:
        known = self.known.get(block)
        if known is not None:
            return known if isinstance(known, Slot) else Slot(block, "block", known)
        if block.tag != "replicate" or block.xpath("boolean(.//body[@mocap='true'])"):
            raise Unknown(block)
        inside = Layout()
        self.visit(block, inside)
        count = int(str(block.get("count") or 1))
        return Slot(block, "block", (count * inside.total("qpos"), count * inside.total("qvel")))

    def actuator(self, actuator: Node) -> Slot:
        tag = actuator.tag
        known = self.known.get(actuator)
        if known is not None:
            return known if isinstance(known, Slot) else Slot(actuator, tag, known)
        activations = _ACTIVATIONS.get(tag)
        if activations is not None:
            return Slot(actuator, tag, (1, activations))
        if tag == "position":
            inherited = self.stateful and self._class(actuator).lookup("position", "timeconst") is not None
            if actuator.get("timeconst") is None and not inherited:
                return Slot(actuator, tag, (1, 0))
        elif tag == "general" and not (self.stateful and self._inherits_state(actuator)):
            if actuator.get("dyntype") in (None, "none"):
                return Slot(actuator, tag, (1, 0))
            return Slot(actuator, tag, (1, int(str(actuator.get("actdim") or 1))))
        raise Unknown(actuator)

    def _inherits_state(self, actuator: Node) -> bool:
        """Whether its class may give it activations or inputs: all actuator tags share one struct."""
        found = self._class(actuator)
        return any(found.lookup("general", name) for name in ("dyntype", "actdim", "input")) or any(
            found.sets(other) for other in (*_STATEFUL, "position")
        )

    def _class(self, actuator: Node) -> DefaultClass:
        return self.unit.classes.get(str(actuator.get("class") or "") or None)


def joint_type(joint: Node, classes: Classes) -> str:
    if joint.tag == "freejoint":
        return "free"
    return classes.effective(joint, childclass_of(joint), "type") or "hinge"


def _own_type(joint: Node) -> str:
    return "free" if joint.tag == "freejoint" else str(joint.get("type") or "hinge")
