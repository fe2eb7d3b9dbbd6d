"""Verb `simplify`: meshes with fewer faces, where nothing weighs what it weighs by them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from lxml.etree import _Element as Node

from composer.compose.collision import mesh_called
from composer.compose.edit_values import Unusable
from composer.compose.editing import Editing
from composer.compose.mesh_asset import write_file
from composer.compose.refuse import refuse
from composer.compose.workshop import Asked, Record, Workshop
from composer.diagnostics.fault import Fault
from composer.link.inertia import has_mass
from composer.plan.made_shapes import MadeShapes
from composer.recipe.fault import Path
from composer.tree.attributes import changing
from composer.tree.classes import own
from composer.tree.select import name_of


def simplify(
    editing: Editing, workshop: Workshop, found: list[Node], value: Mapping[str, Any], at: Path
) -> list[Record]:
    """Give the meshes fewer faces; what has no more than that stays as it is."""
    span = editing.span(at)
    asked: list[Asked] = []
    for mesh in dict.fromkeys(_mesh(editing, node, at) for node in found):
        for geom in _geoms(editing, name_of(mesh) or ""):
            if _is_weighed(editing, geom):
                what = f"the inertia of {_body(editing, geom)} follows from it"
                message = f"{editing.called(mesh)} cannot be simplified: {what}"
                help = (
                    "write the `inertial` of the body, or give the geom `mass: 0` if another one has its mass"
                )
                refuse(editing, geom, Fault("mesh-unusable", message, at, help=help))
        each = workshop.asked(editing, mesh, "simplify", wanted=dict(value), span=span)
        if each is None:
            raise Unusable
        asked.append(each)
    before = editing.sink.error_count
    results = workshop.results(editing, asked)
    if results is None:
        if editing.sink.error_count > before:
            raise Unusable
        return []
    for each in asked:
        _check_textures(editing, each.node, results[each.key], at=at)
    records = [_made(editing, each, results[each.key], at=at) for each in asked]
    workshop.records += records
    return records


def _mesh(editing: Editing, node: Node, at: Path) -> Node:
    if node.tag == "mesh":
        return node
    name = editing.effective(node, "mesh") if node.tag == "geom" else None
    if not name:
        refuse(editing, node, Fault("wrong-type", f"{editing.called(node)} has no mesh to simplify", at))
    return mesh_called(editing, node, str(name), at=at)


def _geoms(editing: Editing, mesh: str) -> Iterator[Node]:
    for section in editing.root.iterchildren("worldbody"):
        for geom in section.iter("geom"):
            if editing.effective(geom, "mesh") == mesh:
                yield geom


def _body(editing: Editing, geom: Node) -> str:
    holder = next(geom.iterancestors("body"), None)
    return "the world" if holder is None else editing.called(holder)


def _is_weighed(editing: Editing, geom: Node) -> bool:
    """Whether the mass of a body comes from the geom, or may."""
    holder = next(geom.iterancestors("body"), None)
    if holder is None or not has_mass(geom, editing.classes):
        return False
    return not own(holder, "inertial") or editing.linking.flat().settings.inertiafromgeom == "true"


def _check_textures(editing: Editing, mesh: Node, result: Mapping[str, Any], at: Path) -> None:
    """Fewer faces do not say where a picture goes on them."""
    if not result["mesh"]["mapped"]:
        return
    for geom in _geoms(editing, name_of(mesh) or ""):
        name = editing.effective(geom, "material") or mesh.get("material")
        material = editing.find_node("material", str(name)) if name else None
        if material is not None and (material.get("texture") or len(material)):
            message = (
                f"{editing.called(mesh)} cannot be simplified: it says where the texture of `{name}` goes"
            )
            help = "select the meshes of geoms without a texture"
            refuse(editing, geom, Fault("mesh-unusable", message, at, help=help))


def _made(editing: Editing, asked: Asked, result: Mapping[str, Any], at: Path) -> Record:
    mesh, name = asked.node, name_of(asked.node) or ""
    shape = result["shapes"][0]
    about = MadeShapes(
        "",
        name,
        "simplify",
        wanted=asked.wanted,
        shapes=(),
        faces=len(shape["faces"]),
        error=result["error"],
        made_with=result["made_with"],
        key=asked.key,
        span=asked.span,
    )
    if len(shape["faces"]) < result["mesh"]["faces"]:
        with changing(editing, mesh):
            if not mesh.get("name"):
                mesh.set("name", name)
            write_file(editing, mesh, name, key=asked.key, shape=shape)
        editing.write(mesh, {"file": at})
    return Record(mesh, mesh, (), about=about)
