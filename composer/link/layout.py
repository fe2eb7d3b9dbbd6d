"""How the numbers of a keyframe are laid out: joints depth first, actuators and mocap bodies in order.

MuJoCo lays out `qpos` body by body, depth first in document order, a body's joints before its children; frames do
not count. What MuJoCo expands (`replicate`, `flexcomp`) is one block here: nothing hangs inside it, so that its inner
order cannot change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from lxml.etree import _Element as Node

from composer.tree.classes import Classes, childclass_of

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


@dataclass(frozen=True, slots=True)
class Slot:
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

    def total(self, vector: str) -> int:
        if vector in ("qpos", "qvel"):
            return sum(slot.widths[vector == "qvel"] for slot in self.joints)
        if vector in ("ctrl", "act"):
            return sum(slot.widths[vector == "act"] for slot in self.actuators)
        return len(self.mocaps) * (3 if vector == "mpos" else 4)


BlockWidths = Callable[[Node], tuple[int, int] | None]


def lay_out(root: Node, measured: dict[Node, tuple[int, ...]]) -> Layout:
    """The layout of a whole model; raises `Unknown` for what neither the tree nor `measured` tells."""
    classes = Classes(root)
    layout = Layout()
    for worldbody in root.iterchildren("worldbody"):
        _visit(worldbody, layout, classes, measured)
    for section in root.iterchildren("actuator"):
        for actuator in section:
            if isinstance(actuator.tag, str):
                layout.actuators.append(_actuator(actuator, classes, measured))
    return layout


def _visit(body: Node, layout: Layout, classes: Classes, measured: dict[Node, tuple[int, ...]]) -> None:
    joints: list[Node] = []
    inner: list[Node] = []
    for child in _through_frames(body):
        if child.tag in ("joint", "freejoint"):
            joints.append(child)
        elif child.tag == "body" or child.tag in _BLOCKS:
            inner.append(child)
    if body.tag == "body" and body.get("mocap") == "true":
        layout.mocaps.append(body)
    for joint in joints:
        kind = joint_type(joint, classes)
        layout.joints.append(Slot(joint, kind, _WIDTHS[kind]))
    for child in inner:
        if child.tag == "body":
            _visit(child, layout, classes, measured)
        else:
            layout.joints.append(Slot(child, "block", _block(child, classes, measured)))


def _through_frames(parent: Node) -> Iterator[Node]:
    for child in parent:
        if child.tag == "frame":
            yield from _through_frames(child)
        elif isinstance(child.tag, str):
            yield child


def joint_type(joint: Node, classes: Classes) -> str:
    if joint.tag == "freejoint":
        return "free"
    return classes.effective(joint, childclass_of(joint), "type") or "hinge"


def _block(block: Node, classes: Classes, measured: dict[Node, tuple[int, ...]]) -> tuple[int, ...]:
    if block in measured:
        return measured[block]
    if block.tag != "replicate":
        raise Unknown(block)
    inside = Layout()
    _visit(block, inside, classes, measured)
    if inside.mocaps:
        raise Unknown(block)
    count = int(str(block.get("count") or 1))
    return count * inside.total("qpos"), count * inside.total("qvel")


def _actuator(actuator: Node, classes: Classes, measured: dict[Node, tuple[int, ...]]) -> Slot:
    tag = str(actuator.tag)
    if actuator in measured:
        return Slot(actuator, tag, measured[actuator])
    if tag in _ACTIVATIONS:
        return Slot(actuator, tag, (1, _ACTIVATIONS[tag]))
    found = classes.get(str(actuator.get("class") or "") or None)
    if tag == "position":
        if actuator.get("timeconst") is None and found.lookup("position", "timeconst") is None:
            return Slot(actuator, tag, (1, 0))
    if tag == "general":
        stateful = ("dyntype", "actdim", "input")
        kinds = ("general", "position", "intvelocity", "cylinder", "muscle", "dcmotor", "pid", "orientation")
        inherited = any(found.lookup(kind, name) for kind in kinds for name in stateful) or any(
            found.sets(kind) for kind in kinds if kind != "general"
        )
        if not inherited:
            dyntype = actuator.get("dyntype")
            if dyntype in (None, "none"):
                return Slot(actuator, tag, (1, 0))
            return Slot(actuator, tag, (1, int(str(actuator.get("actdim") or 1))))
    raise Unknown(actuator)
