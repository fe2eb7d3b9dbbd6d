"""Inertias: impossible ones, repaired if the recipe requests it, and turned ones, which old MuJoCo misreads."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterator
from typing import Any

import numpy
from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.base.sink import Sink
from mjcompose.mujoco.engine import Session, call
from mjcompose.urdf.robot import Robot, by_name, end_of

CODE = "urdf-inertia"
_NAMES = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_SMALLEST = 1e-9
"""The moment (kg m²) for a body without any: above MuJoCo's bound, and negligible."""
_LIGHTEST = 1e-6
"""The mass (kg) for a body without any: above MuJoCo's bound, and negligible."""
_LEAST_MOMENT = 1e-14
"""MuJoCo refuses smaller moments of any body."""
_LEAST_MASS = 1e-15
"""MuJoCo refuses smaller masses of moving bodies."""
_NAMED = 8
Matrix = list[list[float]]
_TURNED = """<robot name="turned">
  <mujoco><compiler fusestatic="false"/></mujoco>
  <link name="base"/>
  <link name="turned">
    <inertial>
      <origin rpy="0 0 1.5707963267948966"/><mass value="1"/>
      <inertia ixx="1" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="joint" type="continuous"><parent link="base"/><child link="turned"/><axis xyz="0 0 1"/></joint>
</robot>"""
"""A link whose smallest moment is about its y axis, because its inertia is turned."""


class Bad(Struct):
    """A link with an impossible inertia, and the reason; `inertial` is None if it is required but missing."""

    link: Node
    inertial: Node | None
    why: str


def bad_inertias(robot: Robot) -> Iterator[Bad]:
    """Yield the links whose inertia MuJoCo refuses."""
    weightless = list(_weightless(robot.root))
    for link in robot.root.iterchildren("link"):
        inertial = link.find("inertial")
        if inertial is None or (tensor := _tensor(inertial)) is None:
            continue
        mass = _mass(inertial)
        values, _ = eigen(tensor)
        shown = f"its principal moments are {_shown(values)}"
        if not mass and not any(any(row) for row in tensor):
            yield Bad(link, inertial, "mass and inertia are zero")
        elif values[0] < _LEAST_MOMENT:
            wrong = "is not positive" if values[0] <= 0 else f"is below {_LEAST_MOMENT:g}"
            yield Bad(link, inertial, f"{shown}: one {wrong}")
        elif values[0] + values[1] < values[2]:
            yield Bad(link, inertial, f"{shown}: the small two add up to less than the third")
        elif 0 <= mass < _LEAST_MASS and link in weightless:
            yield Bad(link, inertial, f"it moves and weighs {mass:g} kg")
    yield from (Bad(link, None, "it moves and has no mass") for link in weightless if link.find("inertial") is None)


def report(robot: Robot, sink: Sink, notes: tuple[Note, ...], *, is_refused: bool) -> None:
    """Report impossible inertias: all, if MuJoCo has refused one, otherwise those of links that joints move.

    MuJoCo does not look at the inertia of a link that it fuses with the world.
    """
    moving = {end_of(joint, "child") for joint in robot.root.iterchildren("joint") if joint.get("type") != "fixed"}
    for bad in bad_inertias(robot):
        if not is_refused and bad.link.get("name") not in moving:
            continue
        sink.error(
            CODE,
            f"the link `{bad.link.get('name')}` has an impossible inertia: {bad.why}",
            _span(robot, bad),
            notes=notes,
            help="correct it, or add `urdf: {inertia: repair}` next to `model`",
            cause=Cause(f"inertia {robot.unit.file}", f"`{bad.link.get('name')}`: {bad.why}"),
        )


def _span(robot: Robot, bad: Bad) -> Span:
    inertia = None if bad.inertial is None else bad.inertial.find("inertia")
    element = next(each for each in (inertia, bad.inertial, bad.link) if each is not None)
    return robot.unit.origins.span(element, robot.unit.file)


def repair(robot: Robot, sink: Sink) -> list[str]:
    """Change each inertia as little as possible, with a warning; return the links whose mass and inertia are zero."""
    massless = []
    weightless = list(_weightless(robot.root))
    for each in list(bad_inertias(robot)):
        robot.changed = True
        name = str(each.link.get("name"))
        span = _span(robot, each)
        if each.inertial is None:
            _write(etree.SubElement(each.link, "inertial"), _LIGHTEST, _diagonal(_SMALLEST))
            became = f"{_LIGHTEST:g} kg and {_SMALLEST:g} kg m²"
        elif (tensor := _tensor(each.inertial)) is None or (not _mass(each.inertial) and not any(map(any, tensor))):
            each.link.remove(each.inertial)
            massless.append(name)
            became = "omitted, and its shapes weigh nothing"
        else:
            repaired, values = _repaired(tensor)
            _write(each.inertial, None, repaired)
            became = f"principal moments {_shown(values)}"
            if 0 <= _mass(each.inertial) < _LEAST_MASS and each.link in weightless:
                _write(each.inertial, _LIGHTEST, repaired)
                became += f", and {_LIGHTEST:g} kg"
        sink.warning(
            CODE,
            f"the inertia of the link `{name}` was repaired: {each.why}; now: {became}",
            span,
            cause=Cause(f"repaired {robot.unit.file}", f"`{name}`: {each.why}; now: {became}"),
        )
    for link in _weightless(robot.root, massless):  # links that were attached to a link without mass
        if link.find("inertial") is None:
            _write(etree.SubElement(link, "inertial"), _LIGHTEST, _diagonal(_SMALLEST))
    return massless


def reads_turned(mujoco: Any, _: None) -> bool:
    """Return whether MuJoCo reads `rpy` of an `<inertial>`. Runs in the child: MuJoCo 3.11 to 3.13 ignore it."""
    model = mujoco.MjSpec.from_string(_TURNED).compile()
    matrix = numpy.zeros(9)
    mujoco.mju_quat2Mat(matrix, model.body("turned").iquat)
    axes = matrix.reshape(3, 3)
    moments = axes @ numpy.diag(model.body("turned").inertia) @ axes.T
    return bool(moments[1, 1] < moments[0, 0])


def turn(robot: Robot, session: Session) -> None:
    """Write inertias in the axes of their links if MuJoCo ignores the `rpy` of their origins."""
    turned = []
    for inertial in robot.root.iterfind("link/inertial"):
        origin = inertial.find("origin")
        tensor = _tensor(inertial)
        angles = None if origin is None else _angles(origin)
        if origin is not None and tensor is not None and angles is not None:
            turned.append((inertial, origin, tensor, angles))
    if not turned or call(session, reads_turned, (), argument=None).value is not False:
        return
    for inertial, origin, tensor, angles in turned:
        axes = _axes(*angles)
        moments = axes @ numpy.array(tensor) @ axes.T
        _write(inertial, None, ((moments + moments.T) / 2).tolist())
        del origin.attrib["rpy"]
        robot.changed = True


def _angles(origin: Node) -> tuple[float, float, float] | None:
    """Return roll, pitch and yaw (rad) of an origin, or None if it is not turned, or if they are no numbers."""
    try:
        roll, pitch, yaw = (float(each) for each in str(origin.get("rpy") or "0 0 0").split())
    except ValueError:
        return None
    is_turned = any((roll, pitch, yaw)) and all(map(math.isfinite, (roll, pitch, yaw)))
    return (roll, pitch, yaw) if is_turned else None


def _axes(roll: float, pitch: float, yaw: float) -> numpy.ndarray:
    """Return the rotation matrix of roll, pitch and yaw (rad), about the fixed axes x, y and z in this order.

    >>> _axes(0, 0, math.pi / 2).round(9).tolist()[0]
    [0.0, -1.0, 0.0]
    """
    about_x = numpy.array([[1, 0, 0], [0, math.cos(roll), -math.sin(roll)], [0, math.sin(roll), math.cos(roll)]])
    about_y = numpy.array([[math.cos(pitch), 0, math.sin(pitch)], [0, 1, 0], [-math.sin(pitch), 0, math.cos(pitch)]])
    about_z = numpy.array([[math.cos(yaw), -math.sin(yaw), 0], [math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
    return numpy.asarray(about_z @ about_y @ about_x)


def _repaired(tensor: Matrix) -> tuple[Matrix, list[float]]:
    """Return the tensor with the same axes and large enough moments, and the moments."""
    values, axes = eigen(tensor)
    floor = max(_SMALLEST, 1e-6 * values[2])
    low, middle, high = (max(each, floor) for each in values)
    moments = [max(low, (high - middle) * (1 + 1e-9)), middle, high]
    turned = [[sum(a * m * b for a, m, b in zip(row, moments, other, strict=True)) for other in axes] for row in axes]
    return turned, sorted(moments)


def _weightless(root: Node, massless: Collection[str] = ()) -> Iterator[Node]:
    """Yield moving links without mass, even counting their shapes and the links fixed to them."""
    joints = list(root.iterchildren("joint"))
    links = by_name(root, "link")
    fixed: dict[str | None, list[str]] = defaultdict(list)
    for joint in joints:
        if joint.get("type") == "fixed":
            fixed[end_of(joint, "parent")].append(str(end_of(joint, "child")))

    def heavy(name: str, seen: set[str]) -> bool:
        link = links.get(name)
        if link is None or name in seen:
            return True
        seen.add(name)
        inertial = link.find("inertial")
        if inertial is None:
            weighs = link.find("collision") is not None and name not in massless
        else:
            weighs = not 0 <= _mass(inertial) < _LEAST_MASS
        return weighs or any(heavy(each, seen) for each in fixed[name])

    for joint in joints:
        name = str(end_of(joint, "child"))
        if joint.get("type") != "fixed" and name in links and not heavy(name, set()):
            yield links[name]


GUESSED = "urdf-mass"


def note_guessed(robot: Robot, sink: Sink, *, is_fixed: bool) -> None:
    """Add one note about the links with shapes and without `<inertial>`, except those that are fixed in the world."""
    joints = list(robot.root.iterchildren("joint"))
    held = {end_of(joint, "child") for joint in joints}
    still = [link.get("name") for link in robot.root.iterchildren("link") if link.get("name") not in held]
    if is_fixed:
        for name in still:
            still += [
                end_of(joint, "child")
                for joint in joints
                if joint.get("type") == "fixed" and end_of(joint, "parent") == name
            ]
    guessed = [
        link
        for link in robot.root.iterchildren("link")
        if link.find("inertial") is None
        and link.find("collision") is not None
        and not (is_fixed and link.get("name") in still)
    ]
    if not guessed:
        return
    subject = "1 link has no `<inertial>` and weighs as much as its shapes"
    if len(guessed) > 1:
        subject = f"{len(guessed)} links have no `<inertial>` and weigh as much as their shapes"
    names = ", ".join(f"`{link.get('name')}`" for link in guessed[:_NAMED])
    more = f" and {len(guessed) - _NAMED} more" if len(guessed) > _NAMED else ""
    message = f"{subject} at 1000 kg/m³: {names}{more}"
    span = robot.unit.origins.span(guessed[0], robot.unit.file, "name")
    sink.note(GUESSED, message, span, help=f"write the `<inertial>`, or `allow: [{GUESSED}]`")


def _mass(inertial: Node) -> float:
    mass = inertial.find("mass")
    try:
        return float((mass is not None and mass.get("value")) or 0)
    except ValueError:
        return math.nan


def _tensor(inertial: Node) -> Matrix | None:
    inertia = inertial.find("inertia")
    if inertia is None:
        return None
    try:
        xx, yy, zz, xy, xz, yz = (float(inertia.get(name) or 0) for name in _NAMES)
    except ValueError:
        return None
    tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return tensor if all(math.isfinite(number) for row in tensor for number in row) else None


def _write(inertial: Node, mass: float | None, tensor: Matrix) -> None:
    numbers = {name: repr(tensor["xyz".index(name[1])]["xyz".index(name[2])]) for name in _NAMES}
    for tag, written in (("mass", {"value": f"{mass:g}"} if mass is not None else {}), ("inertia", numbers)):
        for name, text in written.items():
            child = inertial.find(tag)
            (etree.SubElement(inertial, tag) if child is None else child).set(name, text)


def _diagonal(value: float) -> Matrix:
    return [[value if row == column else 0.0 for column in range(3)] for row in range(3)]


def _shown(values: list[float]) -> str:
    return ", ".join(f"{each:.3g}" for each in values)


def eigen(tensor: Matrix) -> tuple[list[float], Matrix]:
    """Return the principal moments, smallest first, and the axes as columns, by Jacobi's rotations.

    >>> [round(each, 12) for each in eigen([[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 5.0]])[0]]
    [1.0, 3.0, 5.0]
    """
    a = [row[:] for row in tensor]
    v = _diagonal(1.0)
    for _ in range(60):
        row, column = max(((0, 1), (0, 2), (1, 2)), key=lambda at: abs(a[at[0]][at[1]]))
        if abs(a[row][column]) <= 1e-18 * max(abs(a[0][0]), abs(a[1][1]), abs(a[2][2]), 1e-300):
            break
        angle = math.atan2(2 * a[row][column], a[column][column] - a[row][row]) / 2
        c = math.cos(angle)
        s = math.sin(angle)
        for matrix in (a, v):
            for each in matrix:
                each[row], each[column] = c * each[row] - s * each[column], s * each[row] + c * each[column]
        pairs = list(zip(a[row], a[column], strict=True))
        a[row] = [c * x - s * y for x, y in pairs]
        a[column] = [s * x + c * y for x, y in pairs]
    order = sorted(range(3), key=lambda k: a[k][k])
    return [a[k][k] for k in order], [[v[row][k] for k in order] for row in range(3)]
