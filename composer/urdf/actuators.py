"""Actuators for the joints that `<ros2_control>` and `<transmission>` command."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field

from lxml import etree
from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.sources.urdf_choices import Actuators
from composer.tree.unit import Unit
from composer.tree.urdf import locate_as

_MOVES = ("revolute", "continuous", "prismatic")
_KP = ("kp", "p", "position_kp", "position_proportional_gain")
_KD = ("kd", "d", "position_kd", "position_derivative_gain")
_KV = ("kv", "kp", "p", "velocity_kp", "velocity_proportional_gain")
_SIMPLE = "SimpleTransmission"


@dataclass(slots=True)
class Drive:
    """A joint that is commanded: where that is written, by which interfaces, and with what numbers."""

    joint: str
    source: Node
    interfaces: dict[str, Node] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)


def add_actuators(robot: Unit, unit: Unit, choice: Actuators, sink: Sink) -> dict[Node, str]:
    """Add them to `unit`, converted from `robot`; the elements that they come from, with what these became."""
    if choice == "none":
        return {}
    joints = {str(each.get("name")): each for each in robot.root.iterchildren("joint")}
    made = {str(each.get("name")): each for each in unit.root.iter("joint") if each.get("name")}
    read: dict[Node, str] = {}
    drives: dict[str, Drive] = {}
    for drive in (*_of_ros2_control(robot.root), *_of_transmissions(robot.root), *_of_all(joints, choice)):
        if drive.joint not in joints:
            _unknown(drive, list(joints), robot, sink=sink)
            continue
        if joints[drive.joint].find("mimic") is not None:
            read.setdefault(_outer(drive.source), "nothing: an equality moves the joint")
            continue
        drives.setdefault(drive.joint, drive)
        if drive.joint in made:
            read[_outer(drive.source)] = "actuator"
    section: Node | None = None
    for name, drive in drives.items():
        if name not in made:
            continue
        section = unit.section("actuator") if section is None else section
        element = _element(drive, joints[name])
        section.append(element)
        locate_as(unit, element, drive.source, written=robot.origins)
    return read


def _of_ros2_control(root: Node) -> Iterator[Drive]:
    for control in root.iterchildren("ros2_control"):
        for joint in control.iterfind("joint"):
            interfaces = {str(each.get("name")): each for each in joint.iterfind("command_interface")}
            params = {str(each.get("name")): (each.text or "").strip() for each in joint.iterfind("param")}
            if not interfaces or params.get("mimic"):
                continue
            numbers = {name: number for name, text in params.items() if (number := _number(text)) is not None}
            yield Drive(str(joint.get("name")), joint, interfaces, numbers=numbers)


def _of_transmissions(root: Node) -> Iterator[Drive]:
    for transmission in root.iterchildren("transmission"):
        kind = transmission.findtext("type") or transmission.get("type") or ""
        joints, actuators = transmission.findall("joint"), transmission.findall("actuator")
        if not kind.strip().endswith(_SIMPLE) or len(joints) != 1 or len(actuators) > 1:
            continue
        words = [each.text or "" for each in transmission.iterfind(".//hardwareInterface")]
        names = [each.strip().rpartition("/")[2].removesuffix("JointInterface").lower() for each in words]
        yield Drive(str(joints[0].get("name")), transmission, dict.fromkeys(names, transmission))


def _of_all(joints: dict[str, Node], choice: Actuators) -> Iterator[Drive]:
    for name, joint in joints.items() if choice == "all" else ():
        if joint.get("type") in _MOVES and joint.find("mimic") is None:
            yield Drive(name, joint)


def _element(drive: Drive, joint: Node) -> Node:
    """A servo where the URDF has the gains for it; a motor, which applies what the joint may bear, where not.

    All act on the joint itself, as the interfaces of ROS do: `effort` is the joint's, with any reduction.
    """
    limit = joint.find("limit")
    effort = _number(None if limit is None else limit.get("effort")) or 0.0
    velocity = _number(None if limit is None else limit.get("velocity")) or 0.0
    kp, kd, kv = (_first(drive.numbers, names) for names in (_KP, _KD, _KV))
    if "effort" not in drive.interfaces and "position" in drive.interfaces and kp:
        given = {"kp": kp, **({"kv": kd} if kd else {})}
        return _servo(
            "position", drive, given, span=_range(drive.interfaces["position"]) or _joint_range(joint)
        )
    if "effort" not in drive.interfaces and "velocity" in drive.interfaces and kv:
        span = _range(drive.interfaces["velocity"]) or ((-velocity, velocity) if velocity else None)
        return _servo("velocity", drive, {"kv": kv}, span=span)
    span = _range(drive.interfaces.get("effort")) or ((-effort, effort) if effort else None)
    return _servo("motor", drive, {}, span=span)


def _servo(tag: str, drive: Drive, given: dict[str, float], span: tuple[float, float] | None) -> Node:
    element = etree.Element(tag, name=drive.joint, joint=drive.joint)
    for name, value in given.items():
        element.set(name, _text(value))
    if span is not None:
        element.set("ctrlrange", f"{_text(span[0])} {_text(span[1])}")
    return element


def _range(interface: Node | None) -> tuple[float, float] | None:
    """What `<param name="min">` and `max` of an interface say."""
    if interface is None:
        return None
    params = {str(each.get("name")): _number(each.text) for each in interface.iterfind("param")}
    low, high = params.get("min"), params.get("max")
    return (low, high) if low is not None and high is not None and low < high else None


def _joint_range(joint: Node) -> tuple[float, float] | None:
    """The soft limits of a joint, else its limits; None for one without."""
    soft = joint.find("safety_controller")
    for element, low, high in (
        (soft, "soft_lower_limit", "soft_upper_limit"),
        (joint.find("limit"), "lower", "upper"),
    ):
        if element is not None and joint.get("type") != "continuous":
            ends = _number(element.get(low)), _number(element.get(high))
            if ends[0] is not None and ends[1] is not None and ends[0] < ends[1]:
                return ends[0], ends[1]
    return None


def _unknown(drive: Drive, known: list[str], robot: Unit, sink: Sink) -> None:
    tag = "transmission" if drive.source.tag == "transmission" else "ros2_control"
    element = drive.source if drive.source.tag == "joint" else drive.source.find("joint")
    span = robot.origins.span(drive.source if element is None else element, robot.file, "name")
    help = did_you_mean(drive.joint, known, 'name="{}"') or "correct the name, or take the entry out"
    sink.warning(
        "unknown-name", f"`<{tag}>` commands the joint `{drive.joint}`, which does not exist", span,
        notes=(exists_note("joint", known, drive.joint),), help=help,
    )  # fmt: skip


def _outer(source: Node) -> Node:
    """The element that the table has a row for."""
    parent = source.getparent()
    return parent if parent is not None and parent.tag == "ros2_control" else source


def _first(numbers: dict[str, float], names: tuple[str, ...]) -> float | None:
    return next((numbers[name] for name in names if numbers.get(name)), None)


def _number(text: str | None) -> float | None:
    try:
        return float((text or "").strip())
    except ValueError:
        return None


def _text(number: float) -> str:
    return f"{number:.17g}" if float(f"{number:.12g}") != number else f"{number:.12g}"
