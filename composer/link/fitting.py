"""Pass: `fitaabb`, which says how a primitive is fitted to a mesh: the fit becomes an explicit size and pose."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.inertia import measure_alone
from composer.link.linking import Linking
from composer.tree.classes import ORIENTATIONS, Classes, childclass_of, through_frames
from composer.tree.unit import Unit

_ARRAYS = ("geom_size", "geom_pos", "geom_quat")
_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


def fitting(linking: Linking) -> None:
    """Measure the fitted primitives of each unit that fits them to the bounding box."""
    for unit in linking.units if linking.parts else ():
        if unit.settings.fitaabb != "true":
            continue
        classes = unit.classes
        fitted = [
            (at, geom, kind)
            for at, geom in enumerate(_geoms(unit))
            if (kind := classes.effective(geom, childclass_of(geom), "type")) in _SIZES
            and classes.effective(geom, childclass_of(geom), "mesh")
        ]
        if not fitted:
            continue
        arrays = measure_alone(linking, unit, "`fitaabb`", _ARRAYS)
        if arrays is None:
            continue
        for at, geom, kind in fitted:
            _write(geom, at, _SIZES[kind], arrays, classes)


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


def _write(geom: Node, at: int, sizes: int, arrays: Mapping[str, list[float]], classes: Classes) -> None:
    for name in ("mesh", "fitscale", "fromto", *ORIENTATIONS):
        if name in geom.attrib:
            del geom.attrib[name]
    if classes.effective(geom, childclass_of(geom), "mesh"):
        geom.set("mesh", "")
    geom.set("size", numbers.text(arrays["geom_size"][3 * at : 3 * at + sizes]))
    geom.set("pos", numbers.text(arrays["geom_pos"][3 * at : 3 * at + 3]))
    geom.set("quat", numbers.text(arrays["geom_quat"][4 * at : 4 * at + 4]))
