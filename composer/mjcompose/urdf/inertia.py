"""Inertias that no body can have: found before MuJoCo refuses them, and repaired where the recipe asks for that."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Cause
from mjcompose.base.sink import Sink
from mjcompose.urdf.robot import Robot

CODE = "urdf-inertia"
_NAMES = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_SMALLEST, _LIGHTEST = 1e-9, 1e-6
"""What a body gets that has nothing: kg m² and kg, above MuJoCo's own bounds and below what can be felt."""
_LEAST_MOMENT, _LEAST_MASS = 1e-14, 1e-15
"""Below these MuJoCo refuses the moments of any body, and the mass of one that moves."""
_FIXED = "fixed"
Matrix = list[list[float]]


@dataclass(frozen=True, slots=True)
class Bad:
    """A link whose inertia cannot be, and why; `inertial` is None where the link needs one and has none."""

    link: Node
    inertial: Node | None
    why: str


def bad_inertias(robot: Robot) -> Iterator[Bad]:
    """The links whose inertia MuJoCo refuses."""
    weightless = list(_weightless(robot.root))
    for link in robot.root.iterchildren("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        mass, tensor = _mass(inertial), _tensor(inertial)
        if tensor is None:
            continue
        values, _ = eigen(tensor)
        if not mass and not any(any(row) for row in tensor):
            yield Bad(link, inertial, "mass and inertia are zero")
        elif values[0] < _LEAST_MOMENT:
            wrong = "is not positive" if values[0] <= 0 else f"is below {_LEAST_MOMENT:g}"
            yield Bad(link, inertial, f"its principal moments are {_shown(values)}, and one of them {wrong}")
        elif values[0] + values[1] < values[2]:
            why = f"its principal moments are {_shown(values)}, and the two small ones are less than the large one"
            yield Bad(link, inertial, why)
        elif 0 <= mass < _LEAST_MASS and link in weightless:
            yield Bad(link, inertial, f"it moves and weighs {mass:g} kg")
    for link in weightless:
        if link.find("inertial") is None:
            yield Bad(link, None, "it moves and has no mass")


def report(robot: Robot, sink: Sink, notes: tuple[object, ...]) -> bool:
    """Errors for all of them; whether there are any."""
    found = list(bad_inertias(robot))
    for each in found:
        element = each.link if each.inertial is None else _inertia(each.inertial)
        name = each.link.get("name")
        sink.error(
            CODE,
            f"no body can have the inertia of the link `{name}`: {each.why}",
            robot.unit.origins.span(element, robot.unit.file),
            notes=notes,  # type: ignore[arg-type]
            help="correct it, or write beside `model`: `urdf: {inertia: repair}`",
            cause=Cause(f"inertia {robot.unit.file}", f"`{name}`: {each.why}"),
        )
    return bool(found)


def repair(robot: Robot, sink: Sink) -> list[str]:
    """Change each as little as MuJoCo allows, with a warning; the links whose mass and inertia are zero as written."""
    massless, weightless = [], list(_weightless(robot.root))
    for each in list(bad_inertias(robot)):
        robot.changed = True
        name = str(each.link.get("name"))
        element = each.link if each.inertial is None else _inertia(each.inertial)
        span = robot.unit.origins.span(element, robot.unit.file)
        if each.inertial is None:
            _write(etree.SubElement(each.link, "inertial"), _LIGHTEST, _diagonal(_SMALLEST))
            became = f"{_LIGHTEST:g} kg and {_SMALLEST:g} kg m²"
        elif (tensor := _tensor(each.inertial)) is None or (not _mass(each.inertial) and not any(map(any, tensor))):
            each.link.remove(each.inertial)
            massless.append(name)
            became = "left out, and its shapes weigh nothing"
        else:
            repaired, values = _repaired(tensor)
            _write(each.inertial, None, repaired)
            became = f"principal moments {_shown(values)}"
            if 0 <= _mass(each.inertial) < _LEAST_MASS and each.link in weightless:
                _write(each.inertial, _LIGHTEST, repaired)
                became += f", and {_LIGHTEST:g} kg"
        sink.warning(
            CODE, f"the inertia of the link `{name}` was repaired: {each.why}; now: {became}", span,
            cause=Cause(f"repaired {robot.unit.file}", f"`{name}`: {each.why}; now: {became}"),
        )  # fmt: skip
    for link in _weightless(robot.root, massless):  # what was held up by a link whose mass is zero
        if link.find("inertial") is None:
            _write(etree.SubElement(link, "inertial"), _LIGHTEST, _diagonal(_SMALLEST))
    return massless


def _repaired(tensor: Matrix) -> tuple[Matrix, list[float]]:
    """The tensor with its axes, and the smallest moments large enough."""
    values, axes = eigen(tensor)
    floor = max(_SMALLEST, 1e-6 * values[2])
    low, middle, high = (max(each, floor) for each in values)
    low = max(low, (high - middle) * (1 + 1e-9))
    moments = [low, middle, high]
    new = [
        [sum(axes[row][k] * moments[k] * axes[column][k] for k in range(3)) for column in range(3)] for row in range(3)
    ]
    return new, sorted(moments)


def _weightless(root: Node, massless: Collection[str] = ()) -> Iterator[Node]:
    """The links that move by themselves and have, with all that is fixed to them, neither mass nor a shape with one."""
    joints = list(root.iterchildren("joint"))
    fixed: dict[str, list[str]] = {}
    for joint in joints:
        if joint.get("type") == _FIXED:
            fixed.setdefault(_end(joint, "parent"), []).append(_end(joint, "child"))
    links = {str(link.get("name")): link for link in root.iterchildren("link")}

    def heavy(name: str, seen: set[str]) -> bool:
        link = links.get(name)
        if link is None or name in seen:
            return True
        seen.add(name)
        inertial = link.find("inertial")
        if inertial is None and link.find("collision") is not None and name not in massless:
            return True
        if inertial is not None and not 0 <= _mass(inertial) < _LEAST_MASS:
            return True
        return any(heavy(each, seen) for each in fixed.get(name, ()))

    for joint in joints:
        name = _end(joint, "child")
        if joint.get("type") != _FIXED and name in links and not heavy(name, set()):
            yield links[name]


def _end(joint: Node, tag: str) -> str:
    end = joint.find(tag)
    return "" if end is None else str(end.get("link"))


def _inertia(inertial: Node) -> Node:
    found = inertial.find("inertia")
    return inertial if found is None else found


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
    return tensor if all(math.isfinite(each) for row in tensor for each in row) else None


def _write(inertial: Node, mass: float | None, tensor: Matrix) -> None:
    if mass is not None:
        written = inertial.find("mass")
        written = etree.SubElement(inertial, "mass") if written is None else written
        written.set("value", f"{mass:g}")
    inertia = inertial.find("inertia")
    if inertia is None:
        inertia = etree.SubElement(inertial, "inertia")
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    for name, (row, column) in zip(_NAMES, places, strict=True):
        inertia.set(name, repr(tensor[row][column]))


def _diagonal(value: float) -> Matrix:
    return [[value if row == column else 0.0 for column in range(3)] for row in range(3)]


def _shown(values: list[float]) -> str:
    return ", ".join(f"{each:.3g}" for each in values)


def eigen(tensor: Matrix) -> tuple[list[float], Matrix]:
    """The principal moments, smallest first, and the axes as columns, by Jacobi's rotations.

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
        c, s = math.cos(angle), math.sin(angle)
        for matrix in (a, v):
            for each in matrix:
                each[row], each[column] = c * each[row] - s * each[column], s * each[row] + c * each[column]
        a[row], a[column] = (
            [c * x - s * y for x, y in zip(a[row], a[column], strict=True)],
            [s * x + c * y for x, y in zip(a[row], a[column], strict=True)],
        )
    order = sorted(range(3), key=lambda k: a[k][k])
    return [a[k][k] for k in order], [[v[row][k] for k in order] for row in range(3)]
