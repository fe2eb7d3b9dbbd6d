"""The addresses in a compiled model of everything that users address, and the order of elements in it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco import controls as units
from mjcompose.mujoco.addresses import rows_of, span
from mjcompose.mujoco.arrays import BY_WORD, HINGE, JOINT_TYPES, LENGTH, SLIDE, words
from mjcompose.mujoco.attributes import KINDS, ON_BODIES, NameTable, holder, names
from mjcompose.mujoco.controls import AFFINE, is_by_plugin
from mjcompose.mujoco.references import ON_JOINTS, links
from mjcompose.tree.classes import through_frames
from mjcompose.tree.names import WORLD, own_name
from mjcompose.tree.select import WORLD_SECTION, kind_of, naming_attribute

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.mujoco.model_types import MjModel


Range: TypeAlias = tuple[float, float]


class CompiledJoint(Struct):
    """A joint. `range` is in MuJoCo's units (radians, meters) and only valid if `limited`."""

    name: str
    type: str
    qpos_address: int
    qpos_size: int
    dof_address: int
    dof_size: int
    limited: bool
    range: tuple[float, float]
    body: str


class CompiledActuator(Struct):
    """An actuator without activation has `act_address` -1 and `act_size` 0.

    `unit` is the unit of its only control. `ctrl_ranges` has a range or None for each control, in that unit.
    """

    name: str
    ctrl_address: int
    ctrl_size: int
    act_address: int
    act_size: int
    unit: str | None = None
    ctrl_ranges: tuple[Range | None, ...] = ()
    act_range: Range | None = None
    force_range: Range | None = None
    stiffness: float = 0.0
    """The stiffness of a servo at its hinge, in N·m/rad; 0 for any other actuator."""
    joint: str = ""
    """The hinge or slide that it moves directly, if any."""


class CompiledSensor(Struct):
    """A sensor. `type` is its MJCF tag; `cutoff`, in its unit, is None if there is no cutoff."""

    name: str
    type: str
    address: int
    size: int
    unit: str | None = None
    cutoff: float | None = None


class CompiledCamera(Struct):
    """The field of view and the resolution of a camera.

    `fovy` is in degrees, or in meters for an orthographic camera, as `unit` says; `resolution` is width and height.
    """

    name: str
    body: str
    fovy: float
    unit: str
    resolution: tuple[int, int]


class CompiledKeyframe(Struct):
    """A keyframe. `time` is in seconds."""

    name: str
    time: float


class CompiledIndex(Struct):
    """Everything in the order of the compiled model; unnamed elements have the name ''."""

    joints: tuple[CompiledJoint, ...]
    actuators: tuple[CompiledActuator, ...]
    sensors: tuple[CompiledSensor, ...]
    keyframes: tuple[CompiledKeyframe, ...]
    cameras: tuple[CompiledCamera, ...]
    bodies: tuple[str, ...]

    @staticmethod
    def from_data(data: Mapping[str, Any]) -> CompiledIndex:
        """Return the index from its JSON data, `asdict(index)`."""
        kinds = {
            "joints": CompiledJoint,
            "actuators": CompiledActuator,
            "sensors": CompiledSensor,
            "keyframes": CompiledKeyframe,
            "cameras": CompiledCamera,
        }
        rows: dict[str, Any] = {
            name: tuple(kind(**{key: _frozen(value) for key, value in row.items()}) for row in data[name])
            for name, kind in kinds.items()
        }
        return CompiledIndex(**rows, bodies=tuple(data["bodies"]))


class Ranged(NamedTuple):
    """A number of a keyframe that has a range.

    `kind` and `number` identify its joint or actuator, and `vector` is `qpos`, `ctrl` or `act`. `unit` is the unit of
    the value and the range. The value of a ball joint is the angle of its rotation, about any axis.
    """

    kind: str
    number: int
    vector: str
    value: float
    range: Range
    unit: str | None

    def is_within(self, margin: float = 0.0) -> bool:
        """Return whether the value stays `margin` away from both ends, up to rounding: ranges are often rounded."""
        low, high = self.range
        least = low - _ROUNDING * max(1.0, abs(low))
        most = high + _ROUNDING * max(1.0, abs(high))
        return least + margin <= self.value <= most - margin


_ROUNDING = 1e-6


def ranged(index: CompiledIndex, vectors: Mapping[str, Sequence[float]]) -> Iterator[Ranged]:
    """Yield the numbers of a keyframe that have a range; a vector may be empty."""
    qpos, ctrl, act = (vectors[name] for name in ("qpos", "ctrl", "act"))
    for number, joint in enumerate(index.joints if len(qpos) else ()):
        if joint.limited:
            values = qpos[joint.qpos_address : joint.qpos_address + joint.qpos_size]
            bounds = joint.range
            value = float(values[0])
            if joint.type == "ball":
                value = 2 * math.atan2(math.hypot(*values[1:]), abs(value))
                bounds = (0.0, joint.range[1])
            yield Ranged("joint", number, "qpos", value=value, range=bounds, unit=BY_WORD[joint.type].range_unit)
    for number, actuator in enumerate(index.actuators):
        unit = actuator.unit if actuator.ctrl_size == 1 else None
        controls = ctrl[actuator.ctrl_address : actuator.ctrl_address + actuator.ctrl_size]
        for value, limits in zip(controls, actuator.ctrl_ranges, strict=False):
            if limits is not None:
                yield Ranged("actuator", number, "ctrl", value=float(value), range=limits, unit=unit)
        if len(act) and actuator.act_size and actuator.act_range is not None:
            value = float(act[actuator.act_address])
            yield Ranged("actuator", number, "act", value=value, range=actuator.act_range, unit=unit)


def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


def index(model: MjModel, mujoco: Any) -> CompiledIndex:
    """Return the index of a compiled model. Runs in the child process, too, and imports no MuJoCo."""
    bodies = names(model, "body")
    keys = (CompiledKeyframe(name, float(time)) for name, time in zip(names(model, "key"), model.key_time, strict=True))
    return CompiledIndex(
        tuple(_joints(model, bodies)),
        tuple(_actuators(model, mujoco)),
        tuple(_sensors(model, mujoco)),
        keyframes=tuple(keys),
        cameras=tuple(_cameras(model, mujoco, bodies)),
        bodies=tuple(bodies),
    )


def _joints(model: MjModel, bodies: list[str]) -> Iterator[CompiledJoint]:
    for row, name in enumerate(names(model, "joint")):
        qpos = span(model, "qpos", row)
        dofs = span(model, "qvel", row)
        yield CompiledJoint(
            name,
            JOINT_TYPES[int(model.jnt_type[row])].word,
            qpos.start,
            qpos_size=len(qpos),
            dof_address=dofs.start,
            dof_size=len(dofs),
            limited=bool(model.jnt_limited[row]),
            range=_bounds(model.jnt_range[row]),
            body=bodies[holder(model, "joint", row)],
        )


def _actuators(model: MjModel, mujoco: Any) -> Iterator[CompiledActuator]:
    limited = model.actuator_ctrllimited
    bounds = model.actuator_ctrlrange
    joints = names(model, "joint")
    for row, name in enumerate(names(model, "actuator")):
        joint = _joint_of(model, row)
        controls = span(model, "ctrl", row)
        activations = span(model, "act", row)
        yield CompiledActuator(
            name,
            controls.start if controls else 0,
            len(controls),
            act_address=activations.start if activations else -1,
            act_size=len(activations),
            unit=units.of_control(model, mujoco, row) if len(controls) == 1 else None,
            ctrl_ranges=tuple(_bounds(bounds[each]) if limited[each] else None for each in controls),
            act_range=_bounds(model.actuator_actrange[row]) if model.actuator_actlimited[row] else None,
            force_range=_bounds(model.actuator_forcerange[row]) if model.actuator_forcelimited[row] else None,
            stiffness=_stiffness(model, row),
            joint="" if joint is None else joints[joint],
        )


def _stiffness(model: MjModel, row: int) -> float:
    """Return the stiffness that a servo gives a hinge through its gear, in N·m/rad; 0 for any other actuator."""
    joint = _joint_of(model, row)
    if joint is None or int(model.jnt_type[joint]) != HINGE:
        return 0.0
    if is_by_plugin(model, row) or int(model.actuator_biastype[row]) != AFFINE:
        return 0.0
    gear = float(model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=row).start, 0])
    return -float(model.actuator_biasprm[row, 1]) * gear**2


def _joint_of(model: MjModel, row: int) -> int | None:
    """Return the hinge or slide that an actuator moves directly, or None."""
    if int(model.actuator_trntype[row]) not in ON_JOINTS:
        return None
    joint = int(model.actuator_trnid[row, 0])
    return joint if int(model.jnt_type[joint]) in (HINGE, SLIDE) else None


def _bounds(pair: Any) -> Range:
    return float(pair[0]), float(pair[1])


def _sensors(model: MjModel, mujoco: Any) -> Iterator[CompiledSensor]:
    tags = words(mujoco, "sensor_type")
    for row, name in enumerate(names(model, "sensor")):
        tag = tags.get(int(model.sensor_type[row]), "unknown")
        size = int(model.sensor_dim[row])
        data = span(model, "sensordata", row)
        cutoff = float(model.sensor_cutoff[row])
        target = int(model.sensor_objid[row])
        coordinate = None
        if tag.startswith("actuator"):
            coordinate = units.of_transmission(model, target)
        elif tag.startswith("joint"):
            coordinate = JOINT_TYPES[int(model.jnt_type[target])].coordinate
        unit = units.of_sensor(tag, size, coordinate)
        address = data.start if data else 0  # of `<user dim="0">`, which has none
        yield CompiledSensor(name, tag, address, size=len(data), unit=unit, cutoff=cutoff if cutoff > 0 else None)


def _cameras(model: MjModel, mujoco: Any, bodies: list[str]) -> Iterator[CompiledCamera]:
    for row, name in enumerate(names(model, "camera")):
        width, height = map(int, model.cam_resolution[row])
        is_flat = int(model.cam_projection[row]) == int(mujoco.mjtProjection.mjPROJ_ORTHOGRAPHIC)
        body = bodies[holder(model, "camera", row)]
        fovy = float(model.cam_fovy[row])
        yield CompiledCamera(name, body, fovy, unit=LENGTH if is_flat else "deg", resolution=(width, height))


SIZES = ("nq", "nv", "nu", "na", "nsensordata", "nmocap")
VECTORS = ("qpos", "qvel", "act", "ctrl", "mpos", "mquat")
"""The vectors of a keyframe."""


def addresses(mujoco: Any, model: MjModel, _: object) -> dict[str, Any]:
    """Return the index with sizes and the numbers of keyframes; runs under `mjcompose.mujoco.engine.call`."""
    keys = [
        {name: getattr(model, f"key_{name}")[row].ravel().tolist() for name in VECTORS} for row in range(model.nkey)
    ]
    sizes = {name: int(getattr(model, name)) for name in SIZES}
    return {"index": asdict(index(model, mujoco)), "sizes": sizes, "keys": keys}


_STANDING = {**{kind: kind for kind in ON_BODIES}, "freejoint": "joint"}
_REFERRING = ("pair", "exclude", "equality", "tendon", "actuator", "sensor")
# Elements that MuJoCo expands to any number of elements, with the kinds of these.
_BLOCKS: Mapping[str, tuple[str, ...]] = {
    "attach": tuple(KINDS),
    "composite": ("body", "joint", "geom", "site", "exclude", "equality", "tendon", "skin", "plugin"),
    "flexcomp": ("body", "joint", "equality", "flex", "plugin"),
    "replicate": ("body", *ON_BODIES, *_REFERRING, "key"),
}
_SECTIONS = "asset deformable contact equality tendon actuator sensor custom keyframe".split()
# MuJoCo sorts these by their two references: their kind and attributes.
_SORTED = {"pair": ("geom", "geom1", "geom2"), "exclude": ("body", "body1", "body2")}

Order: TypeAlias = "Mapping[str, Sequence[Node | None]]"
"""By kind, the elements in order; None stands for any number of others."""


def compiled_kind(node: Node) -> str | None:
    """Return the kind of object that an element becomes, such as `mesh` or `plugin`, or None if it does not."""
    if node.tag == WORLD_SECTION:
        return "body"
    family = kind_of(node).family
    kind = "plugin" if family == "instance" else family
    return kind if kind in KINDS else None


def compiled_name(node: Node) -> str:
    """Return the name that MuJoCo gives to an element, empty if it has none."""
    if node.tag == WORLD_SECTION:
        return WORLD
    attribute = naming_attribute(kind_of(node))
    return (attribute and own_name(node, attribute.name)) or ""


def compiled_order(root: Node) -> Order:
    """Return bodies depth first, elements on bodies body by body, and everything else in document order.

    >>> from lxml import etree
    >>> order = compiled_order(etree.fromstring(
    ...     '<mujoco><worldbody><body><body><geom name="b"/></body><geom name="a"/></body></worldbody></mujoco>'))
    >>> [geom.get('name') for geom in order['geom']]
    ['a', 'b']
    """
    order: dict[str, list[Node | None]] = {kind: [] for kind in KINDS}
    blocks = {str(block.tag) for block in root.iterdescendants(*_BLOCKS)}
    generated = {kind for block in blocks for kind in _BLOCKS[block]} - {"body", *ON_BODIES}
    for kind in generated:
        order[kind].append(None)
    for kind, element in _in_world(root):
        order[kind].append(element)
    for node in (*root.iterfind("extension//instance"), *chain(*root.iterchildren(*_SECTIONS))):
        own_kind = compiled_kind(node) if isinstance(node.tag, str) else None
        if own_kind is not None:
            order[own_kind].append(node)
    for kind in generated:
        order[kind].append(None)
    return order


def _in_world(root: Node) -> Iterator[tuple[str, Node | None]]:
    """Yield the bodies and the elements on them with their kinds, and None for any number that a block makes."""
    waiting = list(root.iterchildren(WORLD_SECTION))
    while waiting:
        body = waiting.pop()
        if body.tag in _BLOCKS:
            yield from ((kind, None) for kind in _made(body)[1])
            continue
        yield "body", body
        # MuJoCo 4.0 numbers the joints of a body before the joints of its children, even if they are written later.
        inner: list[Node] = []
        for child in through_frames(body):
            if child.tag == "body":
                inner.append(child)
            elif child.tag in _BLOCKS:
                inner.append(child)
                yield from ((kind, None) for kind in _made(child)[0])
            elif child.tag in _STANDING:
                yield _STANDING[str(child.tag)], child
        waiting.extend(reversed(inner))


def rows(order: Order, roster: NameTable) -> dict[Node, int]:
    """Return the number of each element within its kind, of unnamed elements only if the names around them match."""
    found: dict[Node, int] = {}
    # If a body is missing, MuJoCo has moved its elements to others.
    whole = None in order["body"] or len(order["body"]) == roster.count("body")
    for kind, expected in order.items():
        names = roster.names[kind]
        ids = roster.ids[kind]
        if kind in _SORTED:
            found.update(_sorted(kind, expected, roster))
            continue
        stretches = _stretches(expected)
        if sum(map(len, stretches)) == len(names):  # nothing was added
            stretches = [[node for stretch in stretches for node in stretch]]
        for at, stretch in enumerate(stretches):
            start = None
            if whole or kind not in ON_BODIES:
                start = _start(stretch, at == 0, at == len(stretches) - 1, names=names, ids=ids)
            for place, node in enumerate(stretch):
                row = ids.get(compiled_name(node)) if start is None else start + place
                if row is not None:
                    found[node] = row
    return found


def _sorted(kind: str, expected: Sequence[Node | None], roster: NameTable) -> Iterator[tuple[Node, int]]:
    """Yield pairs and excludes, matched by name or by their two references."""
    referred, *attributes = _SORTED[kind]
    places: dict[frozenset[int], list[int]] = {}
    for row in range(roster.count(kind)):
        places.setdefault(frozenset(link.index for link in links(roster.model, kind, row)), []).append(row)
    for node in (element for element in expected if element is not None):
        mine = frozenset(roster.ids[referred].get(str(node.get(attribute)), -1) for attribute in attributes)
        alike = places.get(mine, [])
        element_id = roster.ids[kind].get(compiled_name(node), alike[0] if alike else None)
        if element_id is not None:
            yield node, element_id
        if element_id in alike:
            alike.remove(element_id)


def _start(
    stretch: Sequence[Node], first: bool, last: bool, names: Sequence[str], ids: Mapping[str, int]
) -> int | None:
    own = [compiled_name(node) for node in stretch]
    known = next((ids[name] - at for at, name in enumerate(own) if name in ids), None)
    if first and last and len(own) != len(names):
        return None
    start = 0 if first else len(names) - len(own) if last else known
    return start if start is not None and start >= 0 and names[start : start + len(own)] == own else None


def _stretches(expected: Sequence[Node | None]) -> list[list[Node]]:
    cuts = [-1, *(at for at, node in enumerate(expected) if node is None), len(expected)]
    return [[node for node in expected[one + 1 : other] if node is not None] for one, other in pairwise(cuts)]


def _made(block: Node) -> tuple[set[str], set[str]]:
    """Return the kinds of elements that a block makes on its own body, and below that body."""
    if block.tag != "replicate":
        kinds = {kind for kind in _BLOCKS[str(block.tag)] if kind == "body" or kind in ON_BODIES}
        return (set() if block.tag == "flexcomp" else kinds - {"body"}), kinds
    here: set[str] = set()
    below: set[str] = set()
    for child in through_frames(block):
        if child.tag in _BLOCKS:
            inner = _made(child)
            here |= inner[0]
            below |= inner[1]
        elif child.tag == "body":
            below |= {"body", *ON_BODIES}
        elif child.tag in _STANDING:
            here.add(_STANDING[str(child.tag)])
    return here, below
