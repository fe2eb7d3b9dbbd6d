"""Joints that mimic a joint which cannot lead them: they move by themselves, whatever MuJoCo's version makes of it."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.urdf.robot import Robot, by_name

LEADING = ("revolute", "continuous", "prismatic")
"""The types of joints that others can mimic, and that can mimic others."""


class LostMimic(Struct):
    """A `<mimic>` that leads to nothing: `why` ends a sentence about its joint."""

    mimic: Node
    joint: Node
    why: str
    help: str
    notes: tuple[Note, ...] = ()


def lost_mimics(root: Node) -> Iterator[LostMimic]:
    joints = by_name(root, "joint")
    leads = {name: mimic.get("joint") for name, joint in joints.items() if (mimic := joint.find("mimic")) is not None}
    for name, joint in joints.items():
        mimic = joint.find("mimic")
        if mimic is None or mimic.get("joint") is None or joint.get("type") not in LEADING:
            continue
        leader = str(mimic.get("joint"))
        if leader not in joints:
            help = did_you_mean(leader, list(joints)) or "name a joint of this file"
            notes = (exists_note("joint", list(joints), leader),)
            yield LostMimic(mimic, joint, f"the joint `{leader}`, which `{name}` mimics, does not exist", help, notes)
        elif leader == name:
            yield LostMimic(mimic, joint, f"the joint `{name}` mimics itself", "name the joint that leads it")
        elif joints[leader].get("type") not in LEADING:
            why = f"the joint `{leader}`, which `{name}` mimics, is {joints[leader].get('type')}"
            help = "name a revolute, continuous or prismatic joint"
            yield LostMimic(mimic, joint, why, help)
        elif name in (ring := _ring(name, leads)) and name == min(ring):
            shown = ", which mimics ".join(f"`{each}`" for each in [*ring, name])
            yield LostMimic(mimic, joint, f"joints mimic one another: {shown}", "remove one `<mimic>` of them")


def _ring(name: str, leads: dict[str, str | None]) -> list[str]:
    """Return the joints that a joint follows, one after another, if the last one follows the joint itself."""
    way = [name]
    while (leader := leads.get(way[-1])) is not None and leader not in way:
        way.append(leader)
    return way if leader == name else []


def free_lost_mimics(robot: Robot, sink: Sink) -> None:
    """Remove each `<mimic>` that leads to nothing, with a warning: MuJoCo refuses some of them, and ignores others."""
    for lost in list(lost_mimics(robot.root)):
        message = f"{lost.why}: `{lost.joint.get('name')}` moves by itself"
        span = robot.unit.origins.span(lost.mimic, robot.unit.file, "joint")
        sink.warning("mujoco-warning", message, span, notes=lost.notes, help=lost.help)
        lost.joint.remove(lost.mimic)
        robot.changed = True
