"""Pass: `fitaabb`, which says how a primitive is fitted to a mesh: the fit becomes an explicit size and pose."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.inertia import measure_alone
from composer.link.linking import Linking
from composer.link.placing import read_pose
from composer.pose import Pose
from composer.tree.classes import ORIENTATIONS, Classes, childclass_of, through_frames, walk_bodies
from composer.tree.unit import Unit

_ARRAYS = ("geom_size", "geom_pos", "geom_quat")
_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


def fitting(linking: Linking) -> None:
    """Measure the fitted primitives of each unit that fits them to the bounding box."""
    for unit in linking.units if linking.parts else ():
        if unit.settings.fitaabb != "true":
            continue
        classes = unit.classes
        fitted = {
            geom: kind
            for geom, childclass in walk_bodies(unit.root)
            if geom.tag == "geom" and (kind := _fitted_kind(geom, childclass, classes)) is not None
        }
        arrays = measure_alone(linking, unit, "`fitaabb`", _ARRAYS) if fitted else None
        if arrays is None:
            continue
        for at, geom in enumerate(_geoms(unit)):
            if geom in fitted:
                _write(geom, at, _SIZES[fitted[geom]], arrays, unit)


def _fitted_kind(geom: Node, childclass: str | None, classes: Classes) -> str | None:
    """The primitive that a geom fits to a mesh, if it does."""
    kind = classes.effective(geom, childclass, "type")
    return kind if kind in _SIZES and classes.effective(geom, childclass, "mesh") else None


def _geoms(unit: Unit) -> Iterator[Node]:
    """All geoms as MuJoCo counts them: body by body, depth first."""
    for worldbody in unit.root.iterchildren("worldbody"):
        yield from _below(worldbody)


def _below(body: Node) -> Iterator[Node]:
    own = list(through_frames(body))
    yield from (child for child in own if child.tag == "geom")
    for child in own:
        if child.tag == "body":
            yield from _below(child)


def _write(geom: Node, at: int, sizes: int, arrays: Mapping[str, list[float]], unit: Unit) -> None:
    x, y, z = arrays["geom_pos"][3 * at : 3 * at + 3]
    w, a, b, c = arrays["geom_quat"][4 * at : 4 * at + 4]
    frame = _frames_above(geom, unit)
    pose = Pose((x, y, z), (w, a, b, c))
    if not frame.is_identity:
        pose = frame.inverse() @ pose
    for name in ("mesh", "fitscale", "fromto", *ORIENTATIONS):
        if name in geom.attrib:
            del geom.attrib[name]
    if unit.classes.effective(geom, childclass_of(geom), "mesh"):
        geom.set("mesh", "")
    geom.set("size", numbers.text(arrays["geom_size"][3 * at : 3 * at + sizes]))
    geom.set("pos", numbers.text(pose.pos))
    geom.set("quat", numbers.text(pose.quat))


def _frames_above(geom: Node, unit: Unit) -> Pose:
    """The pose of the frames between a geom and its body: MuJoCo tells where the geom is in the body."""
    pose = Pose()
    node = geom.getparent()
    while node is not None and node.tag == "frame":
        pose = read_pose(node, unit.settings.angle == "degree", unit.settings.eulerseq) @ pose
        node = node.getparent()
    return pose
