"""Pass: where the mass of each body comes from, made explicit where a unit's rule is not MuJoCo's default.

The model itself always says `inertiafromgeom="auto"` and `inertiagrouprange="0 5"`, MuJoCo's defaults.
"""

from __future__ import annotations

from collections.abc import Mapping

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.linking import Linking
from composer.link.placing import pose_in_world, read_pose
from composer.pose import Pose
from composer.tree.classes import ORIENTATIONS, Classes, childclass_of, walk_bodies
from composer.tree.scaled import first_scaled
from composer.tree.settings import Settings
from composer.tree.unit import Unit

_DEFAULT = Settings()
# Rules that change a whole model after its parts: only MuJoCo can say what they give.
MEASURED = ("balanceinertia", "boundmass", "boundinertia", "settotalmass")
ARRAYS = ("body_mass", "body_ipos", "body_iquat", "body_inertia", "body_pos", "body_quat")
_ROUNDING = 1e-9
_EXPANDED = ("replicate", "flexcomp", "composite", "attach")


def inertia(linking: Linking) -> None:
    """Rewrite each unit whose rule differs; a model of one unit keeps its own rules."""
    if not linking.parts:
        return
    for unit in linking.units:
        settings = unit.settings
        if any(getattr(settings, name) != getattr(_DEFAULT, name) for name in MEASURED):
            write_inertias(linking, unit)
            continue
        if settings.inertiagrouprange.split() != ["0", "5"]:
            _leave_out_groups(unit, *(int(bound) for bound in settings.inertiagrouprange.split()))
        if settings.inertiafromgeom == "true":
            _from_geoms(unit)
        elif settings.inertiafromgeom == "false":
            _never_from_geoms(linking, unit)


def _bodies(unit: Unit) -> list[Node]:
    return [element for element, _ in walk_bodies(unit.root) if element.tag == "body"]


def measure_alone(
    linking: Linking, unit: Unit, setting: str, arrays: tuple[str, ...]
) -> Mapping[str, list[float]] | None:
    """Arrays of the unit compiled alone, in the order of its own elements; tells where that cannot be had."""
    compiler = next(unit.root.iterchildren("compiler"), unit.root)
    expanded = next(unit.root.iter(*_EXPANDED), None)
    scaled = first_scaled(unit.root)
    if expanded is None and scaled is None and linking.measure is not None:
        return linking.measure(unit, arrays) or None
    why = "MuJoCo is not at hand"
    if expanded is not None:
        why = f"`<{expanded.tag}>` is expanded by MuJoCo"
    elif scaled is not None:
        why = "MuJoCo scales what is in a `<frame>`"
    linking.sink.error(
        "compiler-setting",
        f"{setting} of `{unit.label}` cannot be kept in a composition: {why}",
        linking.span(unit, compiler, setting.split("`")[1]),
        help="remove the setting from the source, or write the values it gives",
    )
    return None


def _own(body: Node, *tags: str) -> list[Node]:
    """Elements of those tags that belong to the body itself, frames being transparent."""
    found: list[Node] = []
    for child in body:
        if child.tag in tags:
            found.append(child)
        elif child.tag in ("frame", "replicate"):
            found.extend(_own(child, *tags))
    return found


def _leave_out_groups(unit: Unit, low: int, high: int) -> None:
    classes = unit.classes
    for element, childclass in walk_bodies(unit.root):
        if element.tag == "geom":
            group = int(classes.effective(element, childclass, "group") or 0)
            if not low <= group <= high:
                element.set("mass", "0")


def _from_geoms(unit: Unit) -> None:
    """`true`: geoms win over a written inertial; a body without geoms keeps it."""
    classes = unit.classes
    for body in _bodies(unit):
        inertials = _own(body, "inertial")
        if inertials and any(_has_mass(geom, classes) for geom in _own(body, "geom")):
            for inertial in inertials:
                holder = inertial.getparent()
                assert holder is not None
                holder.remove(inertial)


def _has_mass(geom: Node, classes: Classes) -> bool:
    childclass = childclass_of(geom)
    mass = classes.effective(geom, childclass, "mass")
    if mass is not None:
        return numbers.read(mass)[0] != 0
    density = classes.effective(geom, childclass, "density")
    return density is None or numbers.read(density)[0] != 0


def _never_from_geoms(linking: Linking, unit: Unit) -> None:
    """`false`: a body without a written inertial has no mass, whatever its geoms."""
    classes = unit.classes
    for body in _bodies(unit):
        if not _own(body, "inertial"):
            for geom in _own(body, "geom"):
                if _has_mass(geom, classes):
                    geom.set("mass", "0")
            body.insert(0, body.makeelement("inertial", {**_pose(body), "mass": "0", "diaginertia": "0 0 0"}))


def _pose(body: Node) -> dict[str, str]:
    """The frame MuJoCo gives to an inertia that nothing sets: the body's own pose, as written."""
    written = {name: str(body.get(name)) for name in ("pos", *ORIENTATIONS) if body.get(name)}
    return {"pos": "0 0 0", **written}


def write_inertias(linking: Linking, unit: Unit) -> None:
    """Compile the unit alone and write the inertia of every body as MuJoCo has it."""
    wanting = [name for name in MEASURED if getattr(unit.settings, name) != getattr(_DEFAULT, name)]
    arrays = measure_alone(linking, unit, " and ".join(f"`{name}`" for name in wanting), ARRAYS)
    if arrays is None:
        return
    for at, body in enumerate(_bodies(unit), start=1):
        for inertial in _own(body, "inertial"):
            holder = inertial.getparent()
            assert holder is not None
            holder.remove(inertial)
        mass, moments = arrays["body_mass"][at], arrays["body_inertia"][3 * at : 3 * at + 3]
        frame = _aligned(unit, body, _measured_pose(arrays, "body_pos", "body_quat", at))
        inertial_frame = _measured_pose(arrays, "body_ipos", "body_iquat", at)
        if not frame.is_identity:
            inertial_frame = frame @ inertial_frame
        values = {
            "pos": numbers.text(inertial_frame.pos),
            "quat": numbers.text(inertial_frame.quat),
            "mass": numbers.text([mass]),
            "diaginertia": numbers.text(moments),
        }
        if mass or any(moments) or _own(body, "geom"):
            inertial = body.makeelement("inertial", values)
            body.insert(0, inertial)


def _measured_pose(arrays: Mapping[str, list[float]], pos: str, quat: str, at: int) -> Pose:
    x, y, z = arrays[pos][3 * at : 3 * at + 3]
    w, a, b, c = arrays[quat][4 * at : 4 * at + 4]
    return Pose((x, y, z), (w, a, b, c))


def _aligned(unit: Unit, body: Node, measured: Pose) -> Pose:
    """What MuJoCo has moved the frame of a free body by, to align it with the inertia; nothing for other bodies."""
    outer = body.getparent()
    if outer is None or next(body.iterancestors("body"), None) is not None:
        return Pose()
    reading = (unit.settings.angle == "degree", unit.settings.eulerseq)
    moved = (pose_in_world(outer, *reading) @ read_pose(body, *reading)).inverse() @ measured
    return Pose() if _is_rounding(moved) else moved


def _is_rounding(pose: Pose) -> bool:
    return all(abs(value) < _ROUNDING for value in (*pose.pos, *pose.quat[1:]))
