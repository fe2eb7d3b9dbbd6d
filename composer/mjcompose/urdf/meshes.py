"""Meshes and textures of a URDF."""

from __future__ import annotations

import base64
import os
import re
from collections.abc import Iterator
from dataclasses import field
from math import dist
from pathlib import Path
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Cause, Span
from mjcompose.base.files import Refused
from mjcompose.base.sink import Sink
from mjcompose.model.unit import Unit
from mjcompose.mujoco.engine import Session, call
from mjcompose.mujoco.shapes import Doubt, doubts, measured
from mjcompose.urdf.converting import convert, measure
from mjcompose.urdf.robot import FLAT_HELP, Look, Robot, locate_as

CONVERTED = ("dae", "glb", "gltf", "ply", "off", "3mf")
_FOLDER = "converted"
_MOST_FACES = 200_000
"""Of an STL file, in MuJoCo."""
_NO_VOLUME = 1e-12
_ADDRESS = re.compile(r"https?://|ftp://")
_OPEN_HELP = "give the link an `<inertial>`, or close the mesh"


@dataclass(slots=True)
class Meshes:
    """The meshes of one robot; faults go to the sink. `files` are those that nothing in the model names any more."""

    robot: Robot
    session: Session
    sink: Sink
    shown: Any
    files: list[Path] = field(default_factory=list)
    taken: set[str] = field(default_factory=set)
    flat: list[tuple[Doubt, str, Span]] = field(default_factory=list)
    shells: set[str] = field(default_factory=set)
    """The meshes that MuJoCo may weigh as shells, for it needs a volume else: their mass is nowhere used."""

    def prepare(self) -> None:
        """Convert what has to be, and look at what there is."""
        wanted: dict[str, list[Node]] = {}
        for mesh in self._used():
            written = str(mesh.get("filename") or "")
            if _ADDRESS.match(written):
                message = f"`{written}` is an address, and a URDF cannot fetch its meshes"
                help = "download the file, put it beside the URDF, and name it"
                self.sink.error("asset-missing", message, self._span(mesh), help=help)
                continue
            found = self.robot.file_of(str(mesh.get("filename") or ""))
            if found is not None and os.path.isfile(found):
                try:
                    wanted.setdefault(self.robot.unit.door.admit(found), []).append(mesh)
                except Refused as refused:
                    refused.report(self.sink, self._span(mesh), shown=self.shown)
        convertible = [path for path, meshes in wanted.items() if self._is_to_convert(path, meshes)]
        plain = [path for path in wanted if path not in convertible and _suffix(path) in ("stl", "obj")]
        if plain:
            for path, facts in zip(plain, self._ask(measure, plain), strict=True):
                if facts is not None:
                    if facts["volume"] < _NO_VOLUME and all(map(_is_weighed_otherwise, wanted[path])):
                        self.shells.update(str(mesh.get("filename")) for mesh in wanted[path])
                    for mesh in wanted[path]:
                        self._judge(mesh, Path(path), facts)
        if convertible:
            for path, result in zip(convertible, self._ask(convert, convertible), strict=True):
                self._replace(Path(path), wanted[path], result)

    def report_flat(self) -> None:
        """Warn of flat meshes that MuJoCo accepts; where it does not, that is the error."""
        for doubt, message, span in self.flat:
            self.sink.warning(doubt.code, message, span, help=FLAT_HELP)

    def _ask(self, function: Any, files: list[str]) -> list[Any]:
        door = self.robot.unit.door
        argument = {"roots": list(door.roots), "sees_all": door.sees_all, "files": files}
        answer = call(self.session, function, (), argument=argument)
        if answer.ok:
            return list(answer.value)
        self.sink.error(
            "mujoco-timeout" if answer.crash == "timeout" else "mesh-unreadable",
            f"the meshes of `{self.robot.unit.file}` cannot be read: {answer.error or answer.crash}",
            self.robot.unit.origins.span(self.robot.root, self.robot.unit.file),
        )
        return [None if function is measure else {"parts": None} for _ in files]

    def _used(self) -> Iterator[Node]:
        tags = ("collision", "visual") if self.robot.keeps_visuals else ("collision",)
        for link in self.robot.root.iterchildren("link"):
            for shape in link.iterchildren(*tags):
                yield from shape.iterfind("geometry/mesh")

    def _is_to_convert(self, path: str, meshes: list[Node]) -> bool:
        if _suffix(path) == "obj":
            if not any(_shape(mesh).tag == "visual" for mesh in meshes):
                return False
            try:
                return b"mtllib" in self.robot.unit.door.read(path)
            except OSError:
                return False
        if _suffix(path) == "stl":
            return self._is_odd_stl(path)
        return _suffix(path) in CONVERTED

    def _is_odd_stl(self, path: str) -> bool:
        """Whether it is text, or has more faces than MuJoCo reads."""
        try:
            data = self.robot.unit.door.read(path)
        except OSError:
            return False
        count = int.from_bytes(data[80:84], "little")
        is_binary = len(data) >= 84 + 50 * count and count > 0
        return count > _MOST_FACES if is_binary else data.lstrip().startswith(b"solid") and b"vertex" in data

    def _span(self, mesh: Node) -> Span:
        return self.robot.unit.origins.span(mesh, self.robot.unit.file, "filename")

    def _replace(self, path: Path, meshes: list[Node], result: dict[str, Any]) -> None:
        span, called = self._span(meshes[0]), f"`{self.shown(path)}`"
        if result.get("missing"):
            if _suffix(path.name) == "obj":  # MuJoCo reads it, without its materials
                message = f"the materials of {called} are not read: the package `{result['missing']}` is not installed"
                self.sink.note("mesh-look", message, span, help='run `pip install "mjcompose[mesh]"`')
                return
            package = result["missing"]
            message = f"MuJoCo does not read {called}, and the package `{package}`, which does, is not installed"
            self.sink.error("not-installed", message, span, help='run `pip install "mjcompose[mesh]"`',
                            cause=Cause(f"mesh {result['missing']}", called))  # fmt: skip
            return
        if (refused := result.get("refused")) is not None:
            self.robot.unit.door.outside(refused).report(self.sink, span, shown=self.shown)
            return
        if result.get("parts") is None:
            if (why := result.get("error") or result.get("unreadable")) is not None:
                message = f"the mesh {called} cannot be read: {why}"
                self.sink.error("mesh-unreadable", message, span, help="open it in a viewer, and export it anew")
            return
        if not result["parts"]:
            self.sink.error("mesh-unreadable", f"the mesh {called} has no triangles", span,
                            help="export it with its faces, or take it out")  # fmt: skip
            return
        for name in result["lost"]:
            what = f"`{name}`" if "." in name else name
            message = f"{called} names {what} that is not found: what it gives the mesh is left out"
            self.sink.warning("mesh-look", message, span)
        self.files += [path, *(Path(each) for each in result["files"])]
        names = [self._keep(path, part, len(result["parts"])) for part in result["parts"]]
        self.robot.changed = True
        if all(map(_is_weighed_otherwise, meshes)):
            self.shells.update(names)
        for mesh in meshes:
            for part in result["parts"]:
                self._judge(mesh, path, part["measures"])
            self._split(mesh, names)

    def _keep(self, path: Path, part: dict[str, Any], of: int) -> str:
        stem = f"{path.stem}" if of == 1 else f"{path.stem}_{{}}"
        number, name = 0, ""
        while not name or name in self.taken:
            called = stem.format(number) if of > 1 else stem if not number else f"{stem}-{number + 1}"
            name, number = f"{_FOLDER}/{called}.obj", number + 1
        self.taken.add(name)
        self.robot.made[name] = part["obj"].encode()
        texture = None if part["texture"] is None else base64.b64decode(part["texture"])
        rgba = None if part["rgba"] is None else tuple(part["rgba"])
        self.robot.looks[name] = Look(rgba, texture)
        return name

    def _split(self, mesh: Node, names: list[str]) -> None:
        """A shape for each part of its mesh; what the URDF says of its color comes first."""
        shape = _shape(mesh)
        colored = shape.find("material") is not None
        for name in names:
            one = self.robot.copied(shape) if name is not names[-1] else shape
            if name is not names[0] and one.get("name"):
                one.set("name", f"{one.get('name')}_{names.index(name)}")
            inner = one.find("geometry/mesh")
            assert inner is not None
            inner.set("filename", name)
            rgba = self.robot.looks[name].rgba
            if one.tag == "visual" and not colored and rgba is not None:
                material = etree.SubElement(one, "material", name="")
                etree.SubElement(material, "color", rgba=" ".join(f"{each:g}" for each in rgba))

    def _judge(self, mesh: Node, path: Path, facts: dict[str, Any]) -> None:
        """Warn of what is hardly meant."""
        shape, scale = _shape(mesh), _numbers(mesh.get("scale"), (1.0, 1.0, 1.0))
        link, called = shape.getparent(), f"`{self.shown(path)}`"
        touches, inside = shape.tag == "collision", None
        if touches and link is not None and link.find("inertial") is None:
            inside = f"the mass of the link `{link.get('name')}` is computed from it"
        for doubt in doubts(measured(facts, scale), _reach(self.robot.root), touches=touches, inside=inside):
            span, message = self._span(mesh), f"the mesh {called} {doubt.what}"
            match doubt.kind:
                case "flat":  # MuJoCo may refuse it, and that is told once
                    self.flat.append((doubt, message, span))
                case "open":
                    self.sink.warning(doubt.code, message, span, help=_OPEN_HELP)
                case _:
                    cause = Cause(f"{doubt.kind} meshes of {self.robot.unit.file}", called)
                    help = doubt.advice(scale, 'scale="{}"')
                    self.sink.warning(doubt.code, message, span, help=help, cause=cause)


def _shape(mesh: Node) -> Node:
    geometry = mesh.getparent()
    shape = None if geometry is None else geometry.getparent()
    assert shape is not None
    return shape


def _is_weighed_otherwise(mesh: Node) -> bool:
    """Whether the mass of a mesh does not count: it is a look, or its link has an inertia of its own."""
    shape = _shape(mesh)
    link = shape.getparent()
    return shape.tag == "visual" or (link is not None and link.find("inertial") is not None)


def _suffix(path: str) -> str:
    return path.rpartition(".")[2].lower()


def _reach(root: Node) -> float:
    """The largest distance of two joints that follow on each other, in metres."""
    origins = (each.get("xyz") for each in root.iterfind("joint/origin"))
    return max((dist((0, 0, 0), _numbers(each, (0.0, 0.0, 0.0))) for each in origins), default=0.0)


def _numbers(text: str | None, otherwise: tuple[float, ...]) -> tuple[float, ...]:
    try:
        found = tuple(float(each) for each in (text or "").split())
    except ValueError:
        return otherwise
    return found if len(found) == len(otherwise) else otherwise


_MAGIC = b"\x89PNG"


def add_looks(robot: Robot, unit: Unit, pairs: list[tuple[Node, Node]], sink: Sink) -> dict[Node, str]:
    """Give geoms their materials with textures; the `<texture>` elements that were read, with what they became."""
    files = {str(mesh.get("name")): str(mesh.get("file")) for mesh in unit.root.iterfind("asset/mesh")}
    named = {str(each.get("name")): each for each in robot.root.iter("material") if each.find("texture") is not None}
    read: dict[Node, str] = {}
    kept: dict[str, str] = {}
    for element, source in pairs:
        if element.tag != "geom" or source.tag != "visual":
            continue
        material = source.find("material")
        texture = None
        if material is not None:
            texture = material.find("texture")
            texture = texture if texture is not None or material.find("color") is not None else _of(named, material)
        if texture is not None and (look := _picture(robot, texture, sink)) is not None:
            read[texture] = "material and texture"
            path = look.texture
            assert isinstance(path, Path)
            _give(unit, element, source, robot=robot, name=path.stem, picture=path, kept=kept)
        elif material is None or material.get("name") == "":
            found = robot.looks.get(files.get(str(element.get("mesh")), ""))
            if found is not None and isinstance(found.texture, bytes):
                _give(
                    unit, element, source, robot=robot, name=str(element.get("mesh")), picture=found.texture,
                    kept=kept,
                )  # fmt: skip
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
