"""Links: their inertia, and their visual and collision shapes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.plain.numbers import text
from composer.targets.poses import Pose, joined, pose, shifted
from composer.targets.urdf.origin import origin

_SHOWN_GROUPS = 3
"""MuJoCo shows the groups 0, 1 and 2; shapes that only collide are in others by convention."""


def link(draft: Draft, body: int, name: str, package: str) -> Node:
    """Return the link of a body."""
    found = etree.Element("link", name=name)
    if body:
        found.append(_inertial(draft.model, body))
    for number, geom in draft.of("geom"):
        if int(draft.model.geom_bodyid[number]) == body:
            _shapes(draft, number, geom, into=found, package=package)
    return found


def massless(name: str) -> Node:
    """Return a link that only connects joints.

    Its inertia is written as zero: some programs give a link without inertia a mass of their own.
    """
    found = etree.Element("link", name=name)
    inertial = etree.SubElement(found, "inertial")
    etree.SubElement(inertial, "mass", value="0")
    etree.SubElement(inertial, "inertia", dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0"))
    return found


def _inertial(model: Any, body: int) -> Node:
    found = etree.Element("inertial")
    found.append(origin(shifted(model.body_ipos[body])))
    etree.SubElement(found, "mass", value=text(model.body_mass[body]))
    axes = pose((0, 0, 0), model.body_iquat[body])[1]
    matrix = axes @ np.diag(model.body_inertia[body]) @ axes.T
    places = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    etree.SubElement(found, "inertia", {name: text(matrix[at]) for name, at in places.items()})
    return found


def _shapes(draft: Draft, number: int, geom: Node, into: Node, package: str) -> None:
    model = draft.model
    collides = bool(model.geom_contype[number]) or bool(model.geom_conaffinity[number])
    shown = int(model.geom_group[number]) < _SHOWN_GROUPS
    where = pose(model.geom_pos[number], model.geom_quat[number])
    shapes = list(_geometry(draft, number, geom, package=package))
    if not shapes:
        draft.lose(
            "shapes", geom, what=f"the {'height field' if geom.get('type') == 'hfield' else geom.get('type')}"
        )
    for kind in [kind for kind, wanted in (("visual", shown), ("collision", collides)) if wanted]:
        for at, shape in shapes:
            holder = etree.SubElement(into, kind)
            holder.append(origin(joined(where, at)))
            etree.SubElement(holder, "geometry").append(etree.fromstring(etree.tostring(shape)))
            if kind == "visual":
                material = etree.SubElement(holder, "material", name=f"{into.get('name')}_{number}")
                etree.SubElement(material, "color", rgba=text(_colour(model, number)))


def _colour(model: Any, number: int) -> Any:
    material = int(model.geom_matid[number])
    default = bool(np.allclose(model.geom_rgba[number], (0.5, 0.5, 0.5, 1)))
    return model.mat_rgba[material] if material >= 0 and default else model.geom_rgba[number]


def _geometry(draft: Draft, number: int, geom: Node, package: str) -> Iterator[tuple[Pose, Node]]:
    """Yield the shapes of a geom in its frame."""
    size, here = draft.model.geom_size[number], shifted((0, 0, 0))
    match geom.get("type"):
        case "box":
            yield here, etree.Element("box", size=text(2 * size))
        case "sphere":
            yield here, etree.Element("sphere", radius=text(size[0]))
        case "cylinder":
            yield here, _cylinder(size)
        case "capsule":  # which URDF does not have: the same surface in three pieces
            yield here, _cylinder(size)
            for end in (size[1], -size[1]):
                yield shifted((0, 0, end)), etree.Element("sphere", radius=text(size[0]))
        case "mesh":
            meshes = draft.root.iterfind("asset/mesh")
            file = next(each.get("file") for each in meshes if each.get("name") == geom.get("mesh"))
            yield here, etree.Element("mesh", filename=f"package://{package}/{file}")


def _cylinder(size: Any) -> Node:
    return etree.Element("cylinder", radius=text(size[0]), length=text(2 * size[1]))
