"""Textures: of meshes that were converted, and those that `<material>` names, which MuJoCo passes over."""

from __future__ import annotations

import os
from pathlib import Path

from lxml import etree
from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.reading.refused import Refused
from composer.tree.unit import Unit
from composer.tree.urdf import locate_as
from composer.urdf.robot import Look, Robot

_MAGIC = b"\x89PNG"


def add_looks(robot: Robot, unit: Unit, pairs: list[tuple[Node, Node]], sink: Sink) -> dict[Node, str]:
    """Give geoms their materials with textures; the `<texture>` elements that were read, with what they became."""
    files = {str(mesh.get("name")): str(mesh.get("file")) for mesh in unit.root.iterfind("asset/mesh")}
    named = {
        str(each.get("name")): each
        for each in robot.root.iter("material")
        if each.find("texture") is not None
    }
    read: dict[Node, str] = {}
    kept: dict[str, str] = {}
    for element, source in pairs:
        if element.tag != "geom" or source.tag != "visual":
            continue
        material = source.find("material")
        texture = None
        if material is not None:
            texture = material.find("texture")
            texture = (
                texture if texture is not None or material.find("color") is not None else _of(named, material)
            )
        if texture is not None and (look := _picture(robot, texture, sink)) is not None:
            read[texture] = "material and texture"
            path = look.texture
            assert isinstance(path, Path)
            _give(unit, element, source, robot=robot, name=path.stem, picture=path, kept=kept)
        elif material is None or material.get("name") == "":
            found = robot.looks.get(files.get(str(element.get("mesh")), ""))
            if found is not None and isinstance(found.texture, bytes):
                _give(
                    unit,
                    element,
                    source,
                    robot=robot,
                    name=str(element.get("mesh")),
                    picture=found.texture,
                    kept=kept,
                )
    return read


def _of(named: dict[str, Node], material: Node) -> Node | None:
    found = named.get(str(material.get("name")))
    return None if found is None else found.find("texture")


def _picture(robot: Robot, texture: Node, sink: Sink) -> Look | None:
    """The picture of a `<texture>`, if it is one that MuJoCo reads."""
    written = str(texture.get("filename") or "")
    path = robot.file_of(written) if written else None
    span = robot.unit.origins.span(texture, robot.unit.file, "filename")
    if path is None or not os.path.isfile(path):
        sink.warning("asset-missing", f"the texture `{written}` does not exist: the material has none", span)
        return None
    try:
        data = robot.unit.door.read(path)
    except Refused as refused:
        refused.report(sink, span)
        return None
    if not data.startswith(_MAGIC):
        message = f"MuJoCo reads textures as PNG, and `{written}` is not: the material has none"
        sink.warning("mesh-look", message, span, help="convert the picture to PNG")
        return None
    return Look(None, path)


def _give(
    unit: Unit, geom: Node, source: Node, robot: Robot, name: str, picture: bytes | Path, kept: dict[str, str]
) -> None:
    """Let a geom have a material with the picture, which is made once."""
    key = str(picture) if isinstance(picture, Path) else f"{hash(picture)} {len(picture)}"
    material = kept.get(key)
    if material is None:
        material, number = name, 1
        while material in kept.values():
            number += 1
            material = f"{name}-{number}"
        kept[key] = material
        asset = unit.section("asset")
        file = f"converted/{material}.png" if isinstance(picture, bytes) else str(picture)
        if isinstance(picture, bytes):
            unit.contents = {**unit.contents, file: picture}
        for made in (
            etree.SubElement(asset, "texture", name=material, type="2d", file=file),
            etree.SubElement(asset, "material", name=material, texture=material),
        ):
            locate_as(unit, made, source, written=robot.unit.origins)
    geom.set("material", material)
    if "rgba" in geom.attrib:
        del geom.attrib["rgba"]
