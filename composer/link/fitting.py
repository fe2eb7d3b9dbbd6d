"""Pass: `fitaabb`, which selects how primitives are fitted to meshes; the fit becomes an explicit size and pose."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.linking import Linking
from composer.link.measured_unit import GEOMS, Survey, cannot_be_kept, survey
from composer.link.placing import read_pose
from composer.numerics.pose import Pose
from composer.tree.classes import ORIENTATIONS, Classes, childclass_of, walk_bodies
from composer.tree.unit import Unit

_SETTING = ("fitaabb",)
_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


def fitting(linking: Linking) -> None:
    """Measure the fitted primitives of each unit that fits them to the bounding box.

    >>> from composer.link.example import after
    >>> part = (
    ...     '<compiler fitaabb="true"/>'
    ...     '<asset><mesh name="m" vertex="-1 -1 -1 1 1 1 -1 1 1 1 -1 1 1 1 -1 -1 -1 1 -1 1 -1 1 -1 -1"/></asset>'
    ...     '<worldbody><geom type="sphere" mesh="m"/></worldbody>'
    ... )
    >>> after(fitting, part)  # doctest: +ELLIPSIS
    part: <worldbody><geom type="sphere" size="1"...
    """
    for unit in linking.units if linking.composed else ():
        if unit.settings.fitaabb != "true":
            continue
        classes = unit.classes
        fitted = {
            geom: kind
            for geom, childclass in walk_bodies(unit.root)
            if geom.tag == "geom" and (kind := _fitted_kind(geom, childclass, classes)) is not None
        }
        found = survey(linking, unit, _SETTING, GEOMS) if fitted else None
        if found is not None:
            for geom, kind in fitted.items():
                _write(linking, unit, geom, _SIZES[kind], found)


def _fitted_kind(geom: Node, childclass: str | None, classes: Classes) -> str | None:
    """Return the primitive that a geom fits to a mesh, or None if it fits none."""
    kind = classes.effective(geom, childclass, "type")
    return kind if kind in _SIZES and classes.effective(geom, childclass, "mesh") else None


def _write(linking: Linking, unit: Unit, geom: Node, sizes: int, found: Survey) -> None:
    rows = [found.values(geom, array, width) for array, width in zip(GEOMS, (3, 3, 4), strict=True)]
    size, pos, quat = rows
    if size is None or pos is None or quat is None:
        cannot_be_kept(linking, unit, _SETTING, "the copies of a geom differ", geom)
        return
    x, y, z = pos
    w, a, b, c = quat
    frame = _frames_above(geom, unit)
    pose = Pose((x, y, z), (w, a, b, c))
    # MuJoCo dissolves frames: `<frame euler="0 0 90"><geom size="1" pos="1 0 0"/></frame>` has `geom_pos` 0 1 0.
    if not frame.is_identity:
        pose = frame.inverse() @ pose
    for name in ("mesh", "fitscale", "fromto", *ORIENTATIONS):
        if name in geom.attrib:
            del geom.attrib[name]
    # An empty text takes back what the class says: with `<default><geom mesh="m" type="mesh"/></default>` MuJoCo 4.0
    # compiles `<geom mesh="" type="sphere" size="1"/>` to a sphere without a mesh.
    if unit.classes.effective(geom, childclass_of(geom), "mesh"):
        geom.set("mesh", "")
    geom.set("size", numbers.text(size[:sizes]))
    geom.set("pos", numbers.text(pose.pos))
    geom.set("quat", numbers.text(pose.quat))


def _frames_above(geom: Node, unit: Unit) -> Pose:
    """Return the pose of the frames between a geom and its body, since MuJoCo reports the geom's pose in the body."""
    pose = Pose()
    node = geom.getparent()
    while node is not None and node.tag in ("frame", "replicate"):
        if node.tag == "frame":
            pose = read_pose(node, unit.settings.angle == "degree", unit.settings.eulerseq) @ pose
        node = node.getparent()
    return pose
