"""Actuators, friction, springs and mimicry of a URDF, and the report of what was read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.model.merged_settings import ReadRow
from mjcompose.model.unit import Unit
from mjcompose.sources.ros import Actuators
from mjcompose.urdf.robot import locate_as

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
        return _servo("position", drive, given, span=_range(drive.interfaces["position"]) or _joint_range(joint))
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
    for element, low, high in ((soft, "soft_lower_limit", "soft_upper_limit"), (joint.find("limit"), "lower", "upper")):
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


_FRICTION = ("1", "0.005", "0.0001")
"""MuJoCo's default."""


@dataclass(slots=True)
class Extras:
    """`made` has what MuJoCo made of the elements of the URDF. Methods say what became of an element, if anything."""

    robot: Unit
    unit: Unit
    made: dict[Node, list[Node]]

    def add(self) -> dict[Node, str]:
        """All that there is; the elements that were read, and what they became."""
        links = {str(each.get("name")): each for each in self.robot.root.iterchildren("link")}
        joints = {str(each.get("name")): each for each in self.robot.root.iterchildren("joint")}
        read: dict[Node, str] = {}
        for link in links.values():
            contact = link.find("contact")
            if contact is not None and self._contact(link, contact):
                read[contact] = "friction"
        for gazebo in self.robot.root.iterchildren("gazebo"):
            name = gazebo.get("reference")
            for setting in gazebo.iterchildren("*"):
                of_link, of_joint = _OF_LINKS.get(str(setting.tag)), _OF_JOINTS.get(str(setting.tag))
                became = None
                if name in links and of_link is not None:
                    became = of_link(self, links[name], setting)
                elif name in joints and of_joint is not None:
                    became = of_joint(self, joints[name], setting)
                if became is not None:
                    read[setting] = became
        self._mimics(joints)
        return read

    def _geoms(self, link: Node) -> Iterator[Node]:
        for shape in link.iterchildren("collision"):
            yield from (each for each in self.made.get(shape, ()) if each.tag == "geom")

    def _contact(self, link: Node, contact: Node) -> bool:
        """PyBullet's `<contact>`, whose frictions are those of MuJoCo."""
        given = [
            next((each.get("value") for each in contact.iterchildren(f"{kind}_friction")), None)
            for kind in ("lateral", "spinning", "rolling")
        ]
        if not any(_number_extras(each) is not None for each in given):
            return False
        values = [
            str(one) if _number_extras(one) is not None else other for one, other in zip(given, _FRICTION, strict=True)
        ]
        for geom in self._geoms(link):
            self._set(geom, "friction", " ".join(values), source=contact)
            if len([each for each in given[1:] if _number_extras(each)]):
                self._set(geom, "condim", "6" if _number_extras(given[2]) else "4", source=contact)
        return True

    def _friction(self, link: Node, setting: Node) -> str | None:
        if (value := _number_extras(_said(setting))) is None or value < 0:
            return None
        geoms = list(self._geoms(link))
        for geom in geoms:
            self._set(geom, "friction", _said(setting), source=setting)
        return "friction" if geoms else None

    def _gravity(self, link: Node, setting: Node) -> str | None:
        off = {"turnGravityOff": ("true", "1"), "gravity": ("false", "0")}[str(setting.tag)]
        if _said(setting).lower() not in off:
            return "nothing: gravity acts on every body"
        bodies = [each for each in self.made.get(link, ()) if each.tag == "body"]
        for body in bodies:
            self._set(body, "gravcomp", "1", source=setting)
        return "gravcomp" if bodies else None

    def _spring(self, joint: Node, setting: Node) -> str | None:
        if _number_extras(_said(setting)) is None:
            return None
        made = [each for each in self.made.get(joint, ()) if each.tag == "joint"]
        name = {"springStiffness": "stiffness", "springReference": "springref"}[str(setting.tag)]
        for each in made:
            self._set(each, name, _said(setting), source=setting)
        return name if made else None

    def _mimics(self, joints: dict[str, Node]) -> None:
        """The equalities that MuJoCo before 4.0 does not make."""
        moving = {str(each.get("name")): each for each in self.unit.root.iter("joint")}
        held = {each.get("joint1") for each in self.unit.root.iterfind("equality/joint")}
        for name, joint in joints.items():
            mimic = joint.find("mimic")
            if mimic is None or name not in moving or name in held or mimic.get("joint") not in moving:
                continue
            factor, offset = mimic.get("multiplier") or "1", mimic.get("offset") or "0"
            made = etree.SubElement(
                self.unit.section("equality"), "joint", joint1=name, joint2=str(mimic.get("joint")),
                polycoef=f"{offset} {factor} 0 0 0",
            )  # fmt: skip
            locate_as(self.unit, made, mimic, written=self.robot.origins)

    def _set(self, element: Node, name: str, value: str, source: Node) -> None:
        element.set(name, value)
        span = self.robot.origins.span(source, self.robot.file)
        self.unit.origins.settings.setdefault(element, {})[name] = span


_OF_LINKS: dict[str, Callable[[Extras, Node, Node], str | None]] = {
    "mu1": Extras._friction, "mu": Extras._friction, "gravity": Extras._gravity, "turnGravityOff": Extras._gravity,
}  # fmt: skip
_OF_JOINTS: dict[str, Callable[[Extras, Node, Node], str | None]] = {
    "springStiffness": Extras._spring,
    "springReference": Extras._spring,
}


def _said(setting: Node) -> str:
    return (setting.text or setting.get("value") or "").strip()


def _number_extras(text: str | None) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


CODE = "urdf-unread"


@dataclass(slots=True)
class Row:
    """Elements of one kind: what they became (`became`), or why nothing (`why`), and where the first one stands."""

    what: str
    first: Node
    count: int = 0
    became: str = ""
    why: str = ""
    is_minor: bool = False
    """Of nearly every URDF, so that nobody has to be told each time."""


_READ = {
    "link": "body or frame", "link/inertial": "inertial", "link/collision": "geom",
    "joint": "joint, or nothing where it is fixed", "joint/limit": "range and actuatorfrcrange",
    "joint/dynamics": "damping and frictionloss", "joint/mimic": "equality",
    "mujoco": "compiler, option and size", "include": "what it includes",
}  # fmt: skip
_OF_LINKS_AND_JOINTS = frozenset(
    "origin mass inertia geometry box cylinder sphere capsule mesh parent child axis color texture".split()
)
"""What belongs to one of those, and is no row of its own."""
_REDUCTION = "mechanicalReduction"
_UNREAD = {
    "joint/safety_controller": "the limits of a controller of ROS; `range` of the joint is that of `<limit>`",
    "joint/calibration": "where an encoder has its marks; MuJoCo needs no calibration",
    "gazebo/kp": "a stiffness of Gazebo's contacts; for MuJoCo write `solref`",
    "gazebo/kd": "a damping of Gazebo's contacts; for MuJoCo write `solref`",
    "gazebo/mu1": "the link has no shape that collides",
    "gazebo/gravity": "the link is part of another one, and so is its weight",
    "gazebo/turnGravityOff": "the link is part of another one, and so is its weight",
    "gazebo/mu2": "friction in a second direction; MuJoCo has one for both",
    "gazebo/fdir1": "a direction of friction; MuJoCo has one friction for both",
    "gazebo/minDepth": "a number of Gazebo's contacts; for MuJoCo write `solimp`",
    "gazebo/maxVel": "a number of Gazebo's contacts",
    "gazebo/maxContacts": "a number of Gazebo's contacts",
    "gazebo/selfCollide": "links collide in MuJoCo unless they share a joint; to exclude more pairs, write `contact`",
    "gazebo/material": "a material of Gazebo, whose files are not here",
    "gazebo/sensor": "a sensor of Gazebo; write it in `sensor` of the recipe",
    "gazebo/plugin": "a program of Gazebo",
    "gazebo/implicitSpringDamper": "a way of Gazebo to integrate; MuJoCo's damping is implicit",
    "transmission": "only SimpleTransmission of one joint that moves is read",
    f"transmission/{_REDUCTION}": "actuators command the joint and its `effort`; to command the motor, write `gear`",
    "gazebo/provideFeedback": "a setting of Gazebo's joints",
    "gazebo/dampingFactor": "a damping of velocities, which MuJoCo does not have",
    "ros2_control": "what commands no joint: sensors, states, hardware",
    "sensor": "a sensor; write it in `sensor` of the recipe",
    "link/collision_checking": "a setting of another program",
}
_MINOR = frozenset({"joint/limit velocity"})
_NO_WORDS = "MJCF has no words for it"


@dataclass(slots=True)
class Reading:
    """The rows of a URDF, in the order in which their first elements stand."""

    rows: dict[str, Row] = field(default_factory=dict)

    def read(self, what: str, element: Node, became: str) -> None:
        row = self.rows.setdefault(what, Row(what, element, became=became))
        row.count += 1

    def unread(self, what: str, element: Node, why: str | None = None) -> None:
        words = why or _UNREAD.get(what, _NO_WORDS)
        row = Row(what, element, why=words, is_minor=what in _MINOR)
        self.rows.setdefault(f"{what} unread", row).count += 1

    def ordinary(self, root: Node, keeps_visuals: bool, known: Mapping[Node, str]) -> None:
        """Rows for what MuJoCo reads by itself and for what nobody has read; `known` are elements that were read."""
        for child in root.iterchildren("*"):
            tag = _name(child)
            if tag in ("link", "joint"):
                self._one(tag, child)
                if tag == "link" and child.find("inertial") is None and child.find("collision") is not None:
                    self.read("link without inertial", child, "the mass of its shapes at 1000 kg/m³")
                for inner in child.iterchildren("*"):
                    self._inner(tag, inner, keeps_visuals, known=known)
            elif child in known:
                self.read(tag, child, known[child])
                for each in child.iter(_REDUCTION):
                    if not _is_one(each.text):
                        self.unread(f"transmission/{_REDUCTION}", each)
            elif tag == "gazebo":
                for inner in child.iterchildren("*"):
                    self._known(f"gazebo/{_name(inner)}", inner, known)
            elif tag in ("transmission", "ros2_control"):
                self._known(tag, child, known)
            elif tag != "material":
                self._one(tag, child)
        for texture in root.iter("texture"):
            if texture in known:
                self.read("material/texture", texture, known[texture])
            else:
                self.unread("material/texture", texture, "MuJoCo reads no textures of URDF" if keeps_visuals
                            else "only visuals have textures, and they are left out")  # fmt: skip

    def _known(self, what: str, element: Node, known: Mapping[Node, str]) -> None:
        if element in known:
            self.read(what, element, known[element])
        else:
            self.unread(what, element)

    def _inner(self, tag: str, inner: Node, keeps_visuals: bool, known: Mapping[Node, str]) -> None:
        what = f"{tag}/{_name(inner)}"
        if what == "link/visual" and not keeps_visuals:
            self.unread(what, inner, "MuJoCo leaves visuals out; beside `model`, write `urdf: {visuals: keep}`")
        elif what == "link/visual":
            self.read(what, inner, "geom that touches nothing")
        elif inner in known:
            self.read(what, inner, known[inner])
        elif _name(inner) not in _OF_LINKS_AND_JOINTS:
            self._one(what, inner)
        if what == "joint/limit" and _positive(inner.get("velocity")):
            self.unread("joint/limit velocity", inner, "MuJoCo does not limit the velocity of joints")

    def _one(self, what: str, element: Node) -> None:
        if what in _READ:
            self.read(what, element, _READ[what])
        else:
            self.unread(what, element)

    def table(self, unit: Unit) -> tuple[ReadRow, ...]:
        """The rows as data, with the places of their first elements."""
        return tuple(
            ReadRow(
                row.what, row.count, row.became, why=row.why, span=unit.origins.span(row.first, unit.file),
                is_minor=row.is_minor,
            )
            for row in self.rows.values()
        )  # fmt: skip

    def note(self, unit: Unit, sink: Sink) -> None:
        """One note with all that is not in the model."""
        missing = [row for row in self.table(unit) if row.why and not row.is_minor]
        if not missing:
            return
        kinds = f"{len(missing)} kinds of elements are" if len(missing) > 1 else "one kind of element is"
        notes = [Note(f"{row.span}: {row.called}: {row.why}") for row in missing]
        sink.note(
            CODE, f"{kinds} not in the model", unit.origins.span(unit.root, unit.file), notes=notes,
            help=f"`allow: [{CODE}]` acknowledges it",
        )  # fmt: skip


def _positive(text: str | None) -> bool:
    try:
        return 0 < float(text or 0) < 1e6
    except ValueError:
        return False


def _is_one(text: str | None) -> bool:
    try:
        return float(text or 1) == 1
    except ValueError:
        return False


def _name(element: Node) -> str:
    return str(element.tag).rpartition("}")[2]
