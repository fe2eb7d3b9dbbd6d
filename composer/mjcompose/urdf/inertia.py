"""Impossible inertias: found before MuJoCo refuses them, and repaired if the recipe requests it."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterator

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.base.sink import Sink
from mjcompose.urdf.robot import Robot, by_name, end_of

CODE = "urdf-inertia"
_NAMES = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_SMALLEST, _LIGHTEST = 1e-9, 1e-6
"""The moment (kg m²) and mass (kg) for a body without any: above MuJoCo's bounds, and negligible."""
_LEAST_MOMENT, _LEAST_MASS = 1e-14, 1e-15
"""MuJoCo refuses smaller moments of any body, and smaller masses of moving bodies."""
Matrix = list[list[float]]


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


def report(robot: Robot, sink: Sink, notes: tuple[Note, ...]) -> None:
    for bad in bad_inertias(robot):
        sink.error(
            CODE, f"the link `{bad.link.get('name')}` has an impossible inertia: {bad.why}", _span(robot, bad),
            notes=notes, help="correct it, or add `urdf: {inertia: repair}` next to `model`",
            cause=Cause(f"inertia {robot.unit.file}", f"`{bad.link.get('name')}`: {bad.why}"),
        )  # fmt: skip


def _span(robot: Robot, bad: Bad) -> Span:
    inertia = None if bad.inertial is None else bad.inertial.find("inertia")
    element = next(each for each in (inertia, bad.inertial, bad.link) if each is not None)
    return robot.unit.origins.span(element, robot.unit.file)


def repair(robot: Robot, sink: Sink) -> list[str]:
    """Change each inertia as little as possible, with a warning; return the links whose mass and inertia are zero."""
    massless, weightless = [], list(_weightless(robot.root))
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
            CODE, f"the inertia of the link `{name}` was repaired: {each.why}; now: {became}", span,
            cause=Cause(f"repaired {robot.unit.file}", f"`{name}`: {each.why}; now: {became}"),
        )  # fmt: skip
    for link in _weightless(robot.root, massless):  # links that were attached to a link without mass
        if link.find("inertial") is None:
            _write(etree.SubElement(link, "inertial"), _LIGHTEST, _diagonal(_SMALLEST))
    return massless


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
    joints, links = list(root.iterchildren("joint")), by_name(root, "link")
    fixed: dict[str | None, list[str]] = defaultdict(list)
    for joint in joints:
        if joint.get("type") == "fixed":
            fixed[end_of(joint, "parent")].append(str(end_of(joint, "child")))

    def heavy(name: str, seen: set[str]) -> bool:
        link = links.get(name)
        if link is None or name in seen:
            return True
        seen.add(name)
        if (inertial := link.find("inertial")) is None:
            weighs = link.find("collision") is not None and name not in massless
        else:
            weighs = not 0 <= _mass(inertial) < _LEAST_MASS
        return weighs or any(heavy(each, seen) for each in fixed[name])

    for joint in joints:
        name = str(end_of(joint, "child"))
        if joint.get("type") != "fixed" and name in links and not heavy(name, set()):
            yield links[name]


def _mass(inertial: Node) -> float:
    mass = inertial.find("mass")
    try:
        return float((mass is not None and mass.get("value")) or 0)
    except ValueError:
        return math.nan


def _tensor(inertial: Node) -> Matrix | None:
    if (inertia := inertial.find("inertia")) is None:
        return None
    try:
        xx, yy, zz, xy, xz, yz = (float(inertia.get(name) or 0) for name in _NAMES)
    except ValueError:
        return None
    tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return tensor if all(math.isfinite(each) for row in tensor for each in row) else None


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
        c, s = math.cos(angle), math.sin(angle)
        for matrix in (a, v):
            for each in matrix:
                each[row], each[column] = c * each[row] - s * each[column], s * each[row] + c * each[column]
        pairs = list(zip(a[row], a[column], strict=True))
        a[row], a[column] = [c * x - s * y for x, y in pairs], [s * x + c * y for x, y in pairs]
    order = sorted(range(3), key=lambda k: a[k][k])
    return [a[k][k] for k in order], [[v[row][k] for k in order] for row in range(3)]
