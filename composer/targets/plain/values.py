"""Pass: write the poses, sizes and masses that MuJoCo's compiler has computed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.compiled.enums import words
from composer.targets.plain.numbers import text
from composer.tree.classes import ORIENTATIONS

Elements = Mapping[str, Sequence[Node]]
"""By kind: the elements in the order of the compiled model."""

_MESHES = ("mesh", "sdf")


def write_values(mujoco: Any, model: Any, elements: Elements) -> None:
    """Write the compiled values of everything in the body tree."""
    for number, body in enumerate(elements["body"]):
        if number:
            _place(body, model.body_pos[number], model.body_quat[number])
            _inertia(model, number, body)
    for number, joint in enumerate(elements["joint"]):
        if joint.tag == "freejoint":
            joint.set("align", "false")  # has been done
        else:
            joint.set("type", words(mujoco, "jnt_type")[int(model.jnt_type[number])])
            _joint(model, number, joint)
    for number, geom in enumerate(elements["geom"]):
        _shape(geom, words(mujoco, "geom_type")[int(model.geom_type[number])], model.geom_size[number])
        _place(geom, model.geom_pos[number], model.geom_quat[number])
        _geom(model, number, geom)
    for number, site in enumerate(elements["site"]):
        _shape(site, words(mujoco, "site_type")[int(model.site_type[number])], model.site_size[number])
        _place(site, model.site_pos[number], model.site_quat[number])
        # MuJoCo 3.12 saves no `class="main"`, which keeps a site out of the class of its body.
        site.set("group", text(model.site_group[number]))
        if site.get("material") is None:
            site.set("rgba", text(model.site_rgba[number]))
    for number, camera in enumerate(elements["camera"]):
        _place(camera, model.cam_pos[number], model.cam_quat[number])
    for number, light in enumerate(elements["light"]):
        light.set("pos", text(model.light_pos[number]))
        light.set("dir", text(model.light_dir[number]))


def _place(element: Node, pos: Any, quat: Any) -> None:
    for name in ORIENTATIONS:
        element.attrib.pop(name, "")
    element.set("pos", text(pos))
    element.set("quat", text(quat))


def _inertia(model: Any, number: int, body: Node) -> None:
    for old in list(body.iterchildren("inertial")):
        body.remove(old)
    # MuJoCo 4.0 gives a body without one the `pos` of the body as its centre of mass.
    inertial = etree.Element("inertial", mass=text(model.body_mass[number]))
    _place(inertial, model.body_ipos[number], model.body_iquat[number])
    inertial.set("diaginertia", text(model.body_inertia[number]))
    body.insert(0, inertial)


_SPINNING = ("hinge", "slide")


def _joint(model: Any, number: int, joint: Node) -> None:
    joint.set("pos", text(model.jnt_pos[number]))
    limited = bool(model.jnt_limited[number])
    joint.set("limited", "true" if limited else "false")
    dof = int(model.jnt_dofadr[number])
    if joint.get("type") in _SPINNING:
        joint.set("axis", text(model.jnt_axis[number]))
    if limited:
        joint.set("range", text(model.jnt_range[number]))
    for name, value in (
        ("armature", model.dof_armature[dof]), ("frictionloss", model.dof_frictionloss[dof]),
        ("damping", model.dof_damping[dof]), ("stiffness", model.jnt_stiffness[number]),
    ):  # fmt: skip
        if joint.get(name) is None:
            joint.set(name, text(value))


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2}


def _shape(element: Node, shape: str, size: Any) -> None:
    element.attrib.pop("fromto", "")
    element.set("type", shape)
    if shape in _MESHES or shape == "hfield":
        if element.tag == "geom":
            element.attrib.pop("size", "")
    else:
        count = _SIZES.get(shape, 3)
        element.set("size", text(size if size[count:].any() else size[:count]))
        element.attrib.pop("mesh", "")
    element.attrib.pop("fitscale", "")


_GEOM = ("contype", "conaffinity", "condim", "friction", "group")


def _geom(model: Any, number: int, geom: Node) -> None:
    for name in _GEOM:
        geom.set(name, text(getattr(model, f"geom_{name}")[number]))
    for name in ("mass", "density", "shellinertia"):
        geom.attrib.pop(name, "")  # the inertia of its body is written
    if model.body_mass[model.geom_bodyid[number]] == 0:
        geom.set("mass", "0")
    if geom.get("material") is None:
        geom.set("rgba", text(model.geom_rgba[number]))
