"""What of a URDF came into the model, and what did not: a row for each kind of element."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.tree.read_row import ReadRow
from composer.tree.unit import Unit

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
    "link": "body or frame",
    "link/inertial": "inertial",
    "link/collision": "geom",
    "joint": "joint, or nothing where it is fixed",
    "joint/limit": "range and actuatorfrcrange",
    "joint/dynamics": "damping and frictionloss",
    "joint/mimic": "equality",
    "mujoco": "compiler, option and size",
    "include": "what it includes",
}
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
    "gazebo/selfCollide": "links collide in MuJoCo, but for those that share a joint; for more write `contact`",
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
            self.unread(
                what, inner, "MuJoCo leaves visuals out; beside `model`, write `urdf: {visuals: keep}`"
            )
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
                row.what,
                row.count,
                row.became,
                why=row.why,
                span=unit.origins.span(row.first, unit.file),
                is_minor=row.is_minor,
            )
            for row in self.rows.values()
        )

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
    """The tag without its namespace."""
    return str(element.tag).rpartition("}")[2]
