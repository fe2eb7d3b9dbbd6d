"""Actuators, friction, springs and mimicry of a URDF, and the table of the elements that were read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from typing import TypeAlias

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.base.words import number_text, numbers_text
from mjcompose.sources.ros import Actuators
from mjcompose.tree.merged_settings import ReadRow
from mjcompose.tree.unit import Unit
from mjcompose.urdf.robot import by_name, locate_as, written_name

_KP = ("kp", "p", "position_kp", "position_proportional_gain")
_KD = ("kd", "d", "position_kd", "position_derivative_gain")
_KV = ("kv", "kp", "p", "velocity_kp", "velocity_proportional_gain")

_Range = tuple[float, float]


class Drive(Struct, frozen=False):
    """A commanded joint: its source in the URDF, its interfaces and its numbers."""

    joint: str
    source: Node
    interfaces: dict[str, Node] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)


def add_actuators(robot: Unit, unit: Unit, choice: Actuators, sink: Sink) -> dict[Node, str]:
    """Add actuators to `unit`, converted from `robot`; return the URDF elements that they come from, as `read`."""
    if choice == "none":
        return {}
    joints = by_name(robot.root, "joint")
    made = {each.get("name") for each in unit.root.iter("joint")}
    read: dict[Node, str] = {}
    drives: dict[str, Drive] = {}
    free = ((name, joint) for name, joint in joints.items() if joint.find("mimic") is None)
    moving = [
        Drive(name, joint) for name, joint in free if joint.get("type") in ("revolute", "continuous", "prismatic")
    ]
    given = (*_of_ros2_control(robot.root), *_of_transmissions(robot.root))
    for drive in (*given, *(moving if choice == "all" else ())):
        parent = drive.source.getparent()
        row = drive.source if parent is None or parent.tag != "ros2_control" else parent
        if drive.joint not in joints:
            _unknown(drive, list(joints), robot, sink=sink)
        elif joints[drive.joint].find("mimic") is not None:
            read.setdefault(row, "nothing: an equality moves the joint")
        elif drive.joint in made and drives.setdefault(drive.joint, drive) is drive:
            read[row] = "actuator"
    for name, drive in drives.items():
        element = _element(drive, joints[name])
        unit.section("actuator").append(element)
        locate_as(unit, element, drive.source, written=robot.origins)
    return read


def _of_ros2_control(root: Node) -> Iterator[Drive]:
    for control in root.iterchildren("ros2_control"):
        for joint in control.iterfind("joint"):
            interfaces = by_name(joint, "command_interface")
            params = {name: (each.text or "").strip() for name, each in by_name(joint, "param").items()}
            if interfaces and not params.get("mimic"):
                numbers = {name: number for name, text in params.items() if (number := parse(text)) is not None}
                yield Drive(str(joint.get("name")), joint, interfaces, numbers=numbers)


def _of_transmissions(root: Node) -> Iterator[Drive]:
    for transmission in root.iterchildren("transmission"):
        kind = transmission.findtext("type") or transmission.get("type") or ""
        joints = transmission.findall("joint")
        actuators = transmission.findall("actuator")
        if kind.strip().endswith("SimpleTransmission") and len(joints) == 1 and len(actuators) < 2:
            words = [each.text or "" for each in transmission.iterfind(".//hardwareInterface")]
            names = [each.strip().rpartition("/")[2].removesuffix("JointInterface").lower() for each in words]
            yield Drive(str(joints[0].get("name")), transmission, dict.fromkeys(names, transmission))


def _element(drive: Drive, joint: Node) -> Node:
    """Return a servo if the URDF has its gains, or else a motor with the effort of the joint as its range.

    All act on the joint itself, as the interfaces of ROS do: `effort` includes any reduction.
    """
    tag, gains, ends = _servo(drive, joint) or ("motor", {}, _both_ways(_limit(joint, "effort")))
    interface = drive.interfaces.get("effort" if tag == "motor" else tag)
    params = {} if interface is None else by_name(interface, "param")
    own = _ordered(*(parse(params[name].text) if name in params else None for name in ("min", "max")))
    element = etree.Element(tag, name=drive.joint, joint=drive.joint)
    for name, value in gains.items():
        element.set(name, number_text(value))
    ends = own or ends
    if ends is not None:
        element.set("ctrlrange", numbers_text(ends))
    return element


def _servo(drive: Drive, joint: Node) -> tuple[str, dict[str, float], _Range | None] | None:
    """Return the tag, the gains and the range of a servo; None if the URDF lacks its gains, or commands the effort."""
    if "effort" in drive.interfaces:
        return None
    kp, kd, kv = (next(filter(None, map(drive.numbers.get, names)), None) for names in (_KP, _KD, _KV))
    if "position" in drive.interfaces and kp:
        return "position", {"kp": kp, **({"kv": kd} if kd else {})}, _joint_range(joint)
    if "velocity" in drive.interfaces and kv:
        return "velocity", {"kv": kv}, _both_ways(_limit(joint, "velocity"))
    return None


def _limit(joint: Node, name: str) -> float:
    """Return a limit of a joint, 0 if it has none."""
    limit = joint.find("limit")
    return (None if limit is None else parse(limit.get(name))) or 0.0


def _both_ways(most: float) -> _Range | None:
    return (-most, most) if most else None


def _ordered(low: float | None, high: float | None) -> _Range | None:
    return (low, high) if low is not None and high is not None and low < high else None


def _joint_range(joint: Node) -> _Range | None:
    """Return the soft limits of a joint, or else its limits, if it has any."""
    soft = joint.find("safety_controller")
    hard = joint.find("limit")
    places = ((soft, "soft_lower_limit", "soft_upper_limit"), (hard, "lower", "upper"))
    ranges = (_ordered(*(parse(element.get(end)) for end in ends)) for element, *ends in places if element is not None)
    return next(filter(None, ranges), None) if joint.get("type") != "continuous" else None


def _unknown(drive: Drive, known: list[str], robot: Unit, sink: Sink) -> None:
    tag = "transmission" if drive.source.tag == "transmission" else "ros2_control"
    element = drive.source if drive.source.tag == "joint" else drive.source.find("joint")
    span = robot.origins.span(drive.source if element is None else element, robot.file, "name")
    help = did_you_mean(drive.joint, known, 'name="{}"') or "correct the name, or remove the entry"
    sink.warning(
        "unknown-name",
        f"`<{tag}>` commands the joint `{drive.joint}`, which does not exist",
        span,
        notes=(exists_note("joint", known, drive.joint),),
        help=help,
    )


def parse(text: str | None) -> float | None:
    try:
        return float(text or "")
    except ValueError:
        return None


_FRICTION = ("1", "0.005", "0.0001")
"""MuJoCo's default."""


class Extras(Struct, frozen=False):
    """`made` has the elements that MuJoCo made from elements of the URDF. Methods return the result for an element."""

    robot: Unit
    unit: Unit
    made: dict[Node, list[Node]]

    def add(self) -> dict[Node, str]:
        """Add everything. Return the URDF elements that were read, and their results."""
        links = by_name(self.robot.root, "link")
        joints = by_name(self.robot.root, "joint")
        read = {}
        for link in links.values():
            contact = link.find("contact")
            if contact is not None and self._contact(link, contact):
                read[contact] = "friction"
        for setting in self.robot.root.iterfind("gazebo/*"):
            value = (setting.text or setting.get("value") or "").strip()
            gazebo = setting.getparent()
            name = None if gazebo is None else gazebo.get("reference")
            became = None
            if name in links:
                became = self._of_link(links[name], setting, value)
            elif name in joints and (spring := _SPRINGS.get(str(setting.tag))) and parse(value) is not None:
                became = self._set(self._made(joints[name], "joint"), spring, value, source=setting)
            if became is not None:
                read[setting] = became
        self._mimics(joints)
        return read

    def _made(self, source: Node, tag: str) -> list[Node]:
        return [each for each in self.made.get(source, ()) if each.tag == tag]

    def _geoms(self, link: Node) -> list[Node]:
        return [geom for shape in link.iterchildren("collision") for geom in self._made(shape, "geom")]

    def _contact(self, link: Node, contact: Node) -> bool:
        """Read PyBullet's `<contact>`, which has the same frictions as MuJoCo."""
        found = [contact.find(f"{kind}_friction") for kind in ("lateral", "spinning", "rolling")]
        texts = ["" if each is None else str(each.get("value")) for each in found]
        numbers = [*map(parse, texts)]
        if numbers == [None] * 3:
            return False
        rows = zip(texts, numbers, _FRICTION, strict=True)
        values = " ".join(default if number is None else text for text, number, default in rows)
        self._set(self._geoms(link), "friction", values, source=contact)
        if any(numbers[1:]):
            self._set(self._geoms(link), "condim", "6" if numbers[2] else "4", source=contact)
        return True

    def _of_link(self, link: Node, setting: Node, value: str) -> str | None:
        match setting.tag:
            case "mu1" | "mu":
                number = parse(value)
                is_friction = number is not None and not number < 0
                return self._set(self._geoms(link), "friction", value, source=setting) if is_friction else None
            case "gravity" | "turnGravityOff" as tag:
                if value.lower() not in (("true", "1") if tag == "turnGravityOff" else ("false", "0")):
                    return "nothing: gravity acts on every body"
                return self._set(self._made(link, "body"), "gravcomp", "1", source=setting)
        return None

    def _mimics(self, joints: dict[str, Node]) -> None:
        """Add the equalities that MuJoCo before 4.0 does not make."""
        moving = {str(each.get("name")) for each in self.unit.root.iter("joint")}
        held = {each.get("joint1") for each in self.unit.root.iterfind("equality/joint")}
        for name, joint in joints.items():
            mimic = joint.find("mimic")
            if mimic is None or name not in moving or name in held or mimic.get("joint") not in moving:
                continue
            factor = mimic.get("multiplier") or "1"
            offset = mimic.get("offset") or "0"
            made = etree.SubElement(
                self.unit.section("equality"),
                "joint",
                joint1=name,
                joint2=str(mimic.get("joint")),
                polycoef=f"{offset} {factor} 0 0 0",
            )
            locate_as(self.unit, made, mimic, written=self.robot.origins)

    def _set(self, elements: list[Node], name: str, value: str, source: Node) -> str | None:
        span = self.robot.origins.span(source, self.robot.file)
        for element in elements:
            element.set(name, value)
            self.unit.origins.settings.setdefault(element, {})[name] = span
        return name if elements else None


_SPRINGS = {"springStiffness": "stiffness", "springReference": "springref"}
CODE = "urdf-unread"
_READ = {
    "link": "body or frame",
    "link/inertial": "inertial",
    "link/collision": "geom",
    "joint": "joint, or nothing if it is fixed",
    "joint/limit": "range and actuatorfrcrange",
    "joint/dynamics": "damping and frictionloss",
    "joint/mimic": "equality",
    "mujoco": "compiler, option and size",
    "include": "what it includes",
}
_OF_LINKS_AND_JOINTS = frozenset(
    "origin mass inertia geometry box cylinder sphere capsule mesh parent child axis color texture".split()
)
"""Elements without a row of their own."""
_UNREAD = {
    "joint/safety_controller": "the limits of a ROS controller; the joint takes its `range` from `<limit>`",
    "joint/calibration": "the marks of an encoder; MuJoCo needs no calibration",
    "gazebo/kp": "a stiffness of Gazebo's contacts; for MuJoCo write `solref`",
    "gazebo/kd": "a damping of Gazebo's contacts; for MuJoCo write `solref`",
    "gazebo/mu1": "the link has no shape that collides",
    "gazebo/gravity": "the link is part of another link, which includes its weight",
    "gazebo/turnGravityOff": "the link is part of another link, which includes its weight",
    "gazebo/mu2": "friction in a second direction; MuJoCo has the same in both",
    "gazebo/fdir1": "a direction of friction; MuJoCo has the same friction in all",
    "gazebo/minDepth": "a number of Gazebo's contacts; for MuJoCo write `solimp`",
    **dict.fromkeys(("gazebo/maxVel", "gazebo/maxContacts"), "a number of Gazebo's contacts"),
    "gazebo/selfCollide": "links collide in MuJoCo unless they share a joint; to exclude more pairs, write `contact`",
    "gazebo/material": "a material of Gazebo, whose files are not here",
    "gazebo/sensor": "a sensor of Gazebo; write it in `sensor` of the recipe",
    "gazebo/plugin": "a program of Gazebo",
    "gazebo/implicitSpringDamper": "a setting of Gazebo's integrator; MuJoCo's damping is implicit",
    "transmission": "mjcompose reads only the first SimpleTransmission of a moving joint",
    "transmission/mechanicalReduction": "actuators command the joint; to command the motor, write `gear`",
    "gazebo/provideFeedback": "a setting of Gazebo's joints",
    "gazebo/dampingFactor": "a damping of velocities, which MuJoCo does not have",
    "ros2_control": "parts that command no joint: sensors, states, hardware",
    "ros2_control/param": "a setting of the hardware, or a gain that MuJoCo's servos do not have",
    "ros2_control/param mimic": "write `<mimic>` in the `<joint>` of the robot",
    "ros2_control/transmission": "actuators command the joint; to command the motor, write `gear`",
    "sensor": "a sensor; write it in `sensor` of the recipe",
    "link/collision_checking": "a setting of another program",
}


def read_rows(unit: Unit, keeps_visuals: bool, known: Mapping[Node, str]) -> tuple[ReadRow, ...]:
    """Return a row for each kind of element in a URDF; `known` has mjcompose's results for elements."""
    rows: dict[tuple[str, bool], ReadRow] = {}
    for what, element, became, why in _fates(unit.root, keeps_visuals, known):
        key = what, bool(why)
        if key in rows:
            rows[key] = replace(rows[key], count=rows[key].count + 1)
            continue
        span = unit.origins.span(element, unit.file)
        if span != Span(unit.file, 1, 1):  # not `<mujoco>` of our own
            rows[key] = ReadRow(what, 1, became, why=why, span=span, is_minor=what == "joint/limit velocity")
    return tuple(rows.values())


Fate: TypeAlias = tuple[str, Node, str, str]
"""The name of a row, the element, its form in the model, and why it is not there. One of the last two is empty."""


def _fates(root: Node, keeps_visuals: bool, known: Mapping[Node, str]) -> Iterator[Fate]:
    names = {None, *(element.get("name") for element in root.iterchildren("link", "joint"))}
    for element in root.iterchildren("*"):
        tag = written_name(element)
        if tag == "link":
            yield from _fates_of_link(element, keeps_visuals, known)
        elif tag == "joint":
            yield from _fates_of_joint(element, known)
        elif tag == "gazebo" and element.get("reference") not in names:
            yield "gazebo", element, "", f"no link or joint is called `{element.get('reference')}`"
        elif tag == "gazebo" and element not in known:
            for setting in element.iterchildren("*"):
                yield _fate(f"gazebo/{written_name(setting)}", setting, known)
        elif tag != "material" or element in known:
            yield _fate(tag, element, known)
            if tag == "ros2_control":
                yield from _fates_of_control(element)
            if element in known:
                yield from _fates_of_reductions(element, known)
    yield from _fates_of_textures(root, keeps_visuals, known)


def _fate(what: str, element: Node, known: Mapping[Node, str]) -> Fate:
    became = known.get(element) or _READ.get(what, "")
    return what, element, became, "" if became else _UNREAD.get(what, "MJCF has no words for it")


def _fates_of_link(link: Node, keeps_visuals: bool, known: Mapping[Node, str]) -> Iterator[Fate]:
    yield _fate("link", link, known)
    if link.find("inertial") is None and link.find("collision") is not None:
        yield "link without inertial", link, "the mass of its shapes at 1000 kg/m³", ""
    for child in link.iterchildren("*"):
        name = written_name(child)
        if name == "visual":
            yield _fate_of_visual(child, keeps_visuals)
        elif child in known or name not in _OF_LINKS_AND_JOINTS:
            yield _fate(f"link/{name}", child, known)


def _fate_of_visual(visual: Node, keeps_visuals: bool) -> Fate:
    if keeps_visuals:
        return "link/visual", visual, "geom that touches nothing", ""
    return "link/visual", visual, "", "MuJoCo omits visuals; add `urdf: {visuals: keep}` next to `model`"


def _fates_of_joint(joint: Node, known: Mapping[Node, str]) -> Iterator[Fate]:
    yield _fate("joint", joint, known)
    for child in joint.iterchildren("*"):
        name = written_name(child)
        if child in known or name not in _OF_LINKS_AND_JOINTS:
            yield _fate(f"joint/{name}", child, known)
        if name == "limit":
            yield from _fates_of_limit(child, joint)


def _fates_of_limit(limit: Node, joint: Node) -> Iterator[Fate]:
    """Yield the attributes of a `<limit>` that are not in the model."""
    if joint.get("type") == "continuous" and {"lower", "upper"} & set(limit.keys()):
        yield "joint/limit lower", limit, "", "a continuous joint has no limits"
    if 0 < (parse(limit.get("velocity")) or 0) < 1e6:
        yield "joint/limit velocity", limit, "", "MuJoCo does not limit the velocity of joints"


def _fates_of_reductions(transmission: Node, known: Mapping[Node, str]) -> Iterator[Fate]:
    for reduction in transmission.iter("mechanicalReduction"):
        if reduction.text and parse(reduction.text) != 1:
            yield _fate("transmission/mechanicalReduction", reduction, known)


def _fates_of_textures(root: Node, keeps_visuals: bool, known: Mapping[Node, str]) -> Iterator[Fate]:
    why = "MuJoCo reads no textures of URDF" if keeps_visuals else "MuJoCo omits the visuals that have it"
    for texture in root.iter("texture"):
        yield "material/texture", texture, known.get(texture, ""), "" if texture in known else why


def _fates_of_control(control: Node) -> Iterator[Fate]:
    """Yield the parts of a `<ros2_control>` that are not in the actuators of its joints."""
    for param in control.iterfind("joint/param"):
        name = param.get("name")
        if name == "mimic" or name not in (*_KP, *_KD, *_KV, "multiplier", "offset"):
            what = "ros2_control/param mimic" if name == "mimic" else "ros2_control/param"
            yield what, param, "", _UNREAD[what]
    for reduction in control.iterfind("transmission//mechanical_reduction"):
        if parse(reduction.text) != 1:
            yield "ros2_control/transmission", reduction, "", _UNREAD["ros2_control/transmission"]


def note_unread(rows: tuple[ReadRow, ...], unit: Unit, sink: Sink) -> None:
    """Add a note with everything that is not in the model."""
    missing = [row for row in rows if row.why and not row.is_minor]
    if missing:
        are = "kinds of elements are" if len(missing) > 1 else "kind of element is"
        notes = [Note(f"{row.span}: {row.called}: {row.why}") for row in missing]
        sink.note(
            CODE,
            f"{len(missing)} {are} not in the model",
            unit.origins.span(unit.root, unit.file),
            notes=notes,
            help=f"`allow: [{CODE}]` acknowledges it",
        )
