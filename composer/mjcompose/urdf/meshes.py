"""Meshes and textures of a URDF."""

from __future__ import annotations

import base64
import os
import re
from collections.abc import Mapping
from dataclasses import field
from itertools import count
from math import dist
from pathlib import Path
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Span
from mjcompose.base.files import Refused
from mjcompose.base.naming import file_name
from mjcompose.base.sink import Sink
from mjcompose.mujoco.engine import Session, call
from mjcompose.mujoco.shapes import Doubt, doubts, measured
from mjcompose.tree.files import stem
from mjcompose.tree.unit import Unit
from mjcompose.urdf.converting import convert, measure
from mjcompose.urdf.robot import FLAT_HELP, Appearance, Robot, locate_as

CONVERTED = ("dae", "glb", "gltf", "ply", "off", "3mf")
_FOLDER = "converted"
_MOST_FACES = 200_000
"""MuJoCo's limit for an STL file."""
_NO_VOLUME = 1e-12


class Meshes(Struct, frozen=False):
    """The meshes of one robot. Faults go to `sink`. `files` are converted files, which the model no longer names."""

    robot: Robot
    session: Session
    sink: Sink
    shown: Any
    files: list[Path] = field(default_factory=list)
    flat: list[tuple[Doubt, str, Span]] = field(default_factory=list)
    shells: set[str] = field(default_factory=set)
    """Meshes whose mass is not used: MuJoCo may weigh them as shells, which need no volume."""

    def prepare(self) -> None:
        """Convert meshes that MuJoCo does not read, and check all meshes."""
        files = self._files()
        plain, convertible = self._divided(files)
        measurable = [path for path, meshes in plain.items() if meshes and _suffix(path) in ("stl", "obj")]
        for path, facts in self._call(measure, measurable):
            if facts is not None:
                if facts["volume"] < _NO_VOLUME and all(map(_is_weighed_otherwise, files[path])):
                    self.shells.update(str(mesh.get("filename")) for mesh in plain[path])
                for mesh in plain[path]:
                    self._check(mesh, Path(path), facts)
        for path, result in self._call(convert, list(convertible)):
            self._replace(Path(path), convertible[path], result)

    def _files(self) -> dict[str, list[Node]]:
        """Return the meshes of each file that exists, by its path; addresses and files out of sight are reported."""
        files: dict[str, list[Node]] = {}
        for mesh in self.robot.used_meshes():
            written = str(mesh.get("filename") or "")
            if re.match(r"https?://|ftp://", written):
                message = f"`{written}` is an address, but mjcompose does not fetch the meshes of a URDF"
                help = "download the file, put it next to the URDF, and name it"
                self.sink.error("asset-missing", message, self._span(mesh), help=help)
                continue
            path = self.robot.file_of(written)
            if path is not None and os.path.isfile(path):
                try:
                    files.setdefault(self.robot.unit.door.admit(path), []).append(mesh)
                except Refused as refused:
                    self.robot.advised(refused, written).report(self.sink, self._span(mesh), shown=self.shown)
        return files

    def _divided(self, files: dict[str, list[Node]]) -> tuple[dict[str, list[Node]], dict[str, list[Node]]]:
        """Return the meshes that MuJoCo reads, and the meshes to convert, both by path."""
        plain: dict[str, list[Node]] = {}
        convertible: dict[str, list[Node]] = {}
        for path, meshes in files.items():
            shown = [mesh for mesh in meshes if _shape(mesh).tag == "visual"]
            if not self._is_to_convert(path, meshes):
                plain[path] = meshes
            elif _suffix(path) == "obj":  # only its materials need it, which nothing touches
                convertible[path] = shown
                plain[path] = [mesh for mesh in meshes if mesh not in shown]
            else:
                convertible[path] = meshes
        return plain, convertible

    def separate(self) -> None:
        """Give each file a name of its own if MuJoCo takes `visual/link.stl` and `collision/link.stl` for one mesh."""
        files: dict[str, dict[str, list[Node]]] = {}
        for mesh in self.robot.used_meshes():
            written = str(mesh.get("filename") or "")
            path = written if written in self.robot.made else str(self.robot.file_of(written) or written)
            files.setdefault(stem(written), {}).setdefault(path, []).append(mesh)
        alike = [paths for paths in files.values() if len(paths) > 1]
        if not alike or call(self.session, tells_files_apart, (), argument=None).value is not False:
            return
        for paths in alike:
            for path, meshes in list(paths.items())[1:]:
                self._rename(path, meshes)

    def _rename(self, path: str, meshes: list[Node]) -> None:
        robot = self.robot
        if path not in robot.made and not os.path.isfile(path):
            return  # MuJoCo reports it
        content = robot.made.pop(path) if path in robot.made else robot.unit.door.read(path)
        names = (f"{_FOLDER}/{stem(path)}-{number}.{_suffix(path)}" for number in count(2))
        name = next(each for each in names if each not in robot.made)
        robot.made[name] = content
        if path in robot.looks:
            robot.looks[name] = robot.looks.pop(path)
        robot.changed = True
        for mesh in meshes:
            if mesh.get("filename") in self.shells:
                self.shells.add(name)
            mesh.set("filename", name)

    def report_flat(self) -> None:
        """Warn about flat meshes that MuJoCo accepts; for other meshes, MuJoCo reports an error."""
        for doubt, message, span in self.flat:
            self.sink.warning(doubt.code, message, span, help=FLAT_HELP)

    def _call(self, function: Any, files: list[str]) -> list[tuple[str, Any]]:
        """Return each file with the answer of the function; nothing after an error."""
        unit = self.robot.unit
        if not files:
            return []
        argument = {"roots": list(unit.door.roots), "sees_all": unit.door.sees_all, "files": files}
        answer = call(self.session, function, (), argument=argument)
        if answer.ok:
            return list(zip(files, answer.value, strict=True))
        code = "mujoco-timeout" if answer.crash == "timeout" else "mesh-unreadable"
        message = f"the meshes of `{unit.file}` cannot be read: {answer.error or answer.crash}"
        self.sink.error(code, message, unit.origins.span(self.robot.root, unit.file))
        return []

    def _is_to_convert(self, path: str, meshes: list[Node]) -> bool:
        suffix = _suffix(path)
        if suffix == "obj" and not any(_shape(mesh).tag == "visual" for mesh in meshes):
            return False
        if suffix not in ("obj", "stl"):
            return suffix in CONVERTED
        try:
            data = self.robot.unit.door.read(path)
        except OSError:
            return False
        if suffix == "obj":
            return b"mtllib" in data
        count = int.from_bytes(data[80:84], "little")
        is_binary = len(data) >= 84 + 50 * count and count > 0
        return count > _MOST_FACES if is_binary else data.lstrip().startswith(b"solid") and b"vertex" in data

    def _span(self, mesh: Node) -> Span:
        return self.robot.unit.origins.span(mesh, self.robot.unit.file, "filename")

    def _replace(self, path: Path, meshes: list[Node], result: dict[str, Any]) -> None:
        if not self._is_converted(path, meshes, result):
            return
        self.files += [path, *(Path(file) for file in result["files"])]
        self.robot.changed = True
        touching = [mesh for mesh in meshes if _shape(mesh).tag == "collision"]
        is_one = len(result["parts"]) == 1
        parts = []
        if is_one or len(touching) < len(meshes):
            parts = [self._keep_part(path, part, is_one) for part in result["parts"]]
        whole = parts[0] if is_one else self._keep(path, result["whole"], is_one=True) if touching else ""
        if all(map(_is_weighed_otherwise, meshes)):
            self.shells.update([*parts, *filter(None, [whole])])
        for mesh in meshes:
            self._check(mesh, path, result["measures"])
            if mesh in touching:  # one shape, whatever its colors
                mesh.set("filename", whole)
            else:
                self._split(mesh, parts)

    def _is_converted(self, path: Path, meshes: list[Node], result: dict[str, Any]) -> bool:
        """Return whether a file was converted. Report the reason if not, and otherwise the files that it lacks."""
        span = self._span(meshes[0])
        called = f"`{self.shown(path)}`"
        if result.get("missing"):
            self._report_package(path, span, result["missing"])
            return False
        if result.get("refused") is not None:
            self.robot.unit.door.outside(result["refused"]).report(self.sink, span, shown=self.shown)
            return False
        if not result.get("parts"):
            message = f"the mesh {called} has no triangles"
            help = "export it with its faces, or remove it"
            why = result.get("error") or result.get("unreadable")
            if why is not None:
                message = f"the mesh {called} cannot be read: {why}"
                help = "open it in a viewer, and export it again"
            self.sink.error("mesh-unreadable", message, span, help=help)
            return False
        for name in result["lost"]:
            file = f"`{name}`" if "." in name else name
            message = f"{called} names {file}, which does not exist: the mesh looks plain"
            self.sink.warning("mesh-look", message, span)
        return True

    def _report_package(self, path: Path, span: Span, package: str) -> None:
        """Report that a package is not installed: an error, or a note if MuJoCo reads the file by itself."""
        called = f"`{self.shown(path)}`"
        help = 'run `pip install "mjcompose[mesh]"`'
        if _suffix(path.name) == "obj":  # MuJoCo reads it without its materials
            message = f"mjcompose cannot read the materials of {called} without the package `{package}`"
            self.sink.note("mesh-look", message, span, help=help)
        else:
            message = f"mjcompose cannot read {called} without the package `{package}`, and MuJoCo cannot either"
            cause = Cause(f"mesh {package}", called)
            self.sink.error("not-installed", message, span, help=help, cause=cause)

    def _keep_part(self, path: Path, part: dict[str, Any], is_one: bool) -> str:
        name = self._keep(path, part["obj"], is_one=is_one)
        texture = None if part["texture"] is None else base64.b64decode(part["texture"])
        self.robot.looks[name] = Appearance(None if part["rgba"] is None else tuple(part["rgba"]), texture)
        return name

    def _keep(self, path: Path, obj: str, *, is_one: bool) -> str:
        """Keep a converted mesh under a name of its own: of the file, or of one of its parts."""
        ends = ((f"-{number + 1}" if number else "") if is_one else f"_{number}" for number in count())
        names = (f"{_FOLDER}/{path.stem}{end}.obj" for end in ends)
        name = next(each for each in names if each not in self.robot.made)
        self.robot.made[name] = obj.encode()
        return name

    def _split(self, mesh: Node, names: list[str]) -> None:
        """Make a shape for each part of a mesh; a color in the URDF takes precedence."""
        shape = _shape(mesh)
        colored = shape.find("material") is not None
        for number, name in enumerate(names):
            one = self.robot.copied(shape) if name is not names[-1] else shape
            if number and one.get("name"):
                one.set("name", f"{one.get('name')}_{number}")
            inner = one.find("geometry/mesh")
            assert inner is not None
            inner.set("filename", name)
            rgba = self.robot.looks[name].rgba
            if one.tag == "visual" and not colored and rgba is not None:
                material = etree.SubElement(one, "material", name="")
                etree.SubElement(material, "color", rgba=" ".join(f"{each:g}" for each in rgba))

    def _check(self, mesh: Node, path: Path, facts: dict[str, Any]) -> None:
        shape = _shape(mesh)
        scale = _numbers(mesh.get("scale"), (1.0, 1.0, 1.0))
        link = shape.getparent()
        called = f"`{self.shown(path)}`"
        touches = shape.tag == "collision"
        inside = None
        if touches and link is not None and link.find("inertial") is None:
            inside = f"the mass of the link `{link.get('name')}` is computed from it"
        for doubt in doubts(measured(facts, scale), _reach(self.robot.root), touches=touches, inside=inside):
            span = self._span(mesh)
            message = f"the mesh {called} {doubt.what}"
            match doubt.kind:
                case "flat":  # MuJoCo may refuse it, which is reported once
                    self.flat.append((doubt, message, span))
                case "open":
                    help = "give the link an `<inertial>`, or close the mesh"
                    self.sink.warning(doubt.code, message, span, help=help)
                case _:
                    cause = Cause(f"{doubt.kind} meshes of {self.robot.unit.file}", called)
                    help = doubt.advice(scale, 'scale="{}"')
                    self.sink.warning(doubt.code, message, span, help=help, cause=cause)


_ALIKE = """<robot name="alike"><mujoco><compiler strippath="false"/></mujoco><link name="link">
  <collision><geometry><mesh filename="one/mesh.obj"/></geometry></collision>
  <collision><geometry><mesh filename="two/mesh.obj"/></geometry></collision>
</link></robot>"""


def tells_files_apart(mujoco: Any, _: None) -> bool:
    """Return whether MuJoCo reads files of one name in two folders. Runs in the child: 3.12 and 3.13 read the first."""
    return len(mujoco.MjSpec.from_string(_ALIKE).meshes) == 2


def _shape(mesh: Node) -> Node:
    geometry = mesh.getparent()
    shape = None if geometry is None else geometry.getparent()
    assert shape is not None
    return shape


def _is_weighed_otherwise(mesh: Node) -> bool:
    """Return whether the mass of a mesh is unused: it is a visual, or its link has an inertia."""
    shape = _shape(mesh)
    link = shape.getparent()
    return shape.tag == "visual" or (link is not None and link.find("inertial") is not None)


def _suffix(path: str) -> str:
    return path.rpartition(".")[2].lower()


def _reach(root: Node) -> float:
    """Return the largest distance between two consecutive joints, in meters."""
    origins = (each.get("xyz") for each in root.iterfind("joint/origin"))
    return max((dist((0, 0, 0), _numbers(each, (0.0, 0.0, 0.0))) for each in origins), default=0.0)


def _numbers(text: str | None, otherwise: tuple[float, ...]) -> tuple[float, ...]:
    try:
        found = tuple(float(each) for each in (text or "").split())
    except ValueError:
        return otherwise
    return found if len(found) == len(otherwise) else otherwise


def add_looks(robot: Robot, unit: Unit, pairs: list[tuple[Node, Node]], sink: Sink) -> dict[Node, str]:
    """Give geoms their materials with textures; return the `<texture>` elements that were read."""
    files = {str(mesh.get("name")): str(mesh.get("file")) for mesh in unit.root.iterfind("asset/mesh")}
    named = {str(each.get("name")): each.find("texture") for each in robot.root.iterfind(".//material[texture]")}
    read: dict[Node, str] = {}
    kept: dict[str, str] = {}
    for element, source in pairs:
        if element.tag != "geom" or source.tag != "visual":
            continue
        material = source.find("material")
        texture = None if material is None else _texture_of(material, named)
        path = None if texture is None else _picture(robot, texture, sink)
        if texture is not None and path is not None:
            read[texture] = "material and texture"
            _give(unit, element, source, robot=robot, name=path.stem, picture=path, kept=kept)
        elif material is None or material.get("name") == "":
            look = robot.looks.get(files.get(str(element.get("mesh")), ""))
            if look is not None and look.texture is not None:
                name = str(element.get("mesh"))
                _give(unit, element, source, robot=robot, name=name, picture=look.texture, kept=kept)
    return read


def _texture_of(material: Node, named: Mapping[str, Node | None]) -> Node | None:
    """Return the texture of a material, which may only name one of the robot."""
    texture = material.find("texture")
    if texture is None and material.find("color") is None:
        return named.get(str(material.get("name")))
    return texture


def _picture(robot: Robot, texture: Node, sink: Sink) -> Path | None:
    written = str(texture.get("filename") or "")
    path = robot.file_of(written) if written else None
    span = robot.unit.origins.span(texture, robot.unit.file, "filename")
    if path is None or not os.path.isfile(path):
        sink.warning("asset-missing", f"the texture `{written}` does not exist: the material has no texture", span)
        return None
    try:
        data = robot.unit.door.read(path)
    except Refused as refused:
        refused.report(sink, span)
        return None
    if not data.startswith(b"\x89PNG"):
        message = f"MuJoCo reads only PNG, and `{written}` is not: the material has no texture"
        sink.warning("mesh-look", message, span, help="convert the picture to PNG")
        return None
    return path


def _give(
    unit: Unit, geom: Node, source: Node, robot: Robot, name: str, picture: bytes | Path, kept: dict[str, str]
) -> None:
    """Give a geom a material with the picture, made once."""
    key = str(picture) if isinstance(picture, Path) else f"{hash(picture)} {len(picture)}"
    material = kept.get(key)
    if material is None:
        names = (name if number == 1 else f"{name}-{number}" for number in count(1))
        material = kept[key] = next(candidate for candidate in names if candidate not in kept.values())
        asset = unit.section("asset")
        file = str(picture)
        if isinstance(picture, bytes):
            file = f"converted/{file_name(material)}.png"
            unit.contents = {**unit.contents, file: picture}
        for made in (
            etree.SubElement(asset, "texture", name=material, type="2d", file=file),
            etree.SubElement(asset, "material", name=material, texture=material),
        ):
            locate_as(unit, made, source, written=robot.unit.origins)
    geom.set("material", material)
    geom.attrib.pop("rgba", "")
