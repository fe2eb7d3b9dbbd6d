"""Rules about assets and licenses."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.files import Refused, read_regular
from mjcompose.lint.rule import Finding, Found, Subject, rule
from mjcompose.sources import license
from mjcompose.tree.cost import pixels
from mjcompose.tree.files import file_attributes, is_absolute, join, written_path
from mjcompose.tree.mesh_cost import file_points
from mjcompose.tree.unit import Unit

_LARGE_TEXTURE = 4096 * 4096
_FINE_MESH = 200_000
_HEAVY = 5_000_000
_ASSET = {"robot-asset": "SPDX: each file that is passed on names its license"}


@rule(
    "no-license",
    "A model without a license",
    in_files=True,
    profiles={"menagerie": "README, Overview: each folder has a `LICENSE`", **_ASSET},
)
def license_missing(subject: Subject) -> Found:
    unit = subject.unit
    if unit is None or not subject.is_part or unit.origins.texts.get(unit.file) is None:
        return
    path = unit.directory / os.path.basename(unit.file)
    is_small = subject.root.find("asset/mesh") is None and sum(1 for _ in subject.each("body")) <= 10
    head = unit.origins.texts[unit.file].split().text[:5000]
    if is_small or license.find(path) or _is_packaged(path) or "license" in head.lower() or "copyright" in head.lower():
        return
    help = "add a file `LICENSE` next to the model, or a comment `SPDX-License-Identifier: …`"
    yield Finding(subject.root, "the model names no license, and there is no license file near it", help=help)


def _is_packaged(path: Path) -> bool:
    """Return whether the file belongs to an installed Python package that has a license."""
    return any(next(folder.glob("*.dist-info/**/LICEN*"), None) is not None for folder in list(path.parents)[:8])


@rule(
    "absolute-path",
    "A file named by a path that exists on one machine only",
    profiles={"robot-asset": "references between files are relative (OpenUSD, SimReady)"},
)
def absolute_path(subject: Subject) -> Found:
    places = [*file_attributes(subject.root)]
    folders = ("meshdir", "texturedir", "assetdir")
    for each in subject.root.iterfind("compiler"):
        places += [(each, name, str(each.get(name))) for name in folders if each.get(name)]
    for element, attribute, value in places:
        if is_absolute(value) or "\\" in value or value[1:2] == ":":
            message = f"the path `{value}` exists on one machine or system only"
            yield Finding(element, message, attribute, help="write a path relative to the model, with `/`")


def _real(element: Node, value: str, unit: Unit) -> str | None:
    path = written_path(unit.settings, element, value)
    if path in unit.contents:
        return None
    try:
        return unit.door.admit(join(str(unit.directory), path))
    except (OSError, Refused):
        return None


def _assets(subject: Subject) -> Iterator[tuple[Node, str, str]]:
    if subject.unit is not None:
        for element, attribute, value in file_attributes(subject.root):
            real = _real(element, value, subject.unit)
            if real is not None and os.path.isfile(real):
                yield element, attribute, real


@rule("same-file-twice", "Two files with the same bytes", in_files=True)
def same_file_twice(subject: Subject) -> Found:
    sizes: dict[int, list[tuple[Node, str, str]]] = {}
    seen: set[str] = set()
    for element, attribute, real in _assets(subject):
        if real not in seen and (size := os.path.getsize(real)) > 10_000:
            sizes.setdefault(size, []).append((element, attribute, real))
            seen.add(real)
    for alike in sizes.values():
        first: dict[str, str] = {}
        if len(alike) > 1:
            for element, attribute, real in alike:
                other = first.setdefault(hashlib.sha256(read_regular(real)).hexdigest(), real)
                if other != real:
                    message = f"`{os.path.basename(real)}` has the same bytes as `{os.path.basename(other)}`"
                    yield Finding(element, message, attribute)


@rule("texture-too-large", "A texture with more than 4096 × 4096 pixels", in_files=True)
def texture_too_large(subject: Subject) -> Found:
    if subject.unit is None:
        return
    for element, attribute, _ in file_attributes(subject.root):
        if element.tag == "texture" and (count := pixels(element, attribute, subject.unit)) > _LARGE_TEXTURE:
            message = f"the image has {count / 1e6:.0f} million pixels, {3 * count / 1e6:.0f} MB in memory"
            yield Finding(element, message, attribute, help="write an image of at most 4096 × 4096 pixels")


@rule("mesh-too-fine", "A mesh with more than 200,000 points", in_files=True)
def mesh_too_fine(subject: Subject) -> Found:
    if subject.unit is None:
        return
    for element in subject.root.iterfind("asset/mesh"):
        if element.get("file") and (points := file_points(element, subject.unit)) > _FINE_MESH:
            message = f"the mesh has at least {points:,} points"
            yield Finding(element, message, "file", help="reduce it, for example with `edit: {simplify: …}`")


@rule("file-too-large", "A file of more than 5 MB", in_files=True)
def file_too_large(subject: Subject) -> Found:
    seen: set[str] = set()
    for element, attribute, real in _assets(subject):
        size = os.path.getsize(real)
        if size > _HEAVY and real not in seen:
            seen.add(real)
            message = f"`{os.path.basename(real)}` has {size / 1e6:.1f} MB"
            yield Finding(element, message, attribute, help="reduce it, or save it in a binary format")


_SCENE = {"menagerie": "CONTRIBUTING, Code Style: always have a `scene.xml` that includes the model"}


@rule("no-scene", "A robot without a scene that shows it", in_files=True, usual=False, profiles=_SCENE)
def no_scene(subject: Subject) -> Found:
    unit = subject.unit
    if unit is None or not subject.is_part or next(subject.each("joint", "freejoint"), None) is None:
        return
    name = os.path.basename(unit.file)
    beside = [read_regular(path) for path in unit.directory.glob("*scene*.xml") if os.path.isfile(path)]
    if "scene" not in name and not any(name.encode() in text for text in beside):
        yield Finding(subject.root, f"no scene next to the model includes `{name}`")


@rule(
    "floor-in-model",
    "A floor in the file of a robot",
    usual=False,
    profiles={"menagerie": "README, Overview: the model file only describes the model"},
)
def floor_in_model(subject: Subject) -> Found:
    is_scene = subject.unit is not None and "scene" in os.path.basename(subject.unit.file)
    if not is_scene and subject.root.find("worldbody//joint") is not None:
        for element in subject.root.iterfind("worldbody/geom"):
            if subject.value(element, "type") == "plane" and subject.is_own(element):
                yield Finding(element, f"{subject.called(element)} is a floor in the file of a robot")


_SECTIONS = ("compiler", "option", "size", "asset", "default", "worldbody")


@rule(
    "section-order",
    "A model whose body tree comes before its settings, assets or classes",
    usual=False,
    profiles={
        "menagerie": (
            "CONTRIBUTING, Code Style: compiler, asset and default first, then worldbody, actuators and others"
        ),
    },
)
def section_order(subject: Subject) -> Found:
    body = next(filter(subject.is_own, subject.root.iterfind("worldbody")), None)
    if body is not None:
        for element in body.itersiblings(*_SECTIONS[:-1]):
            if subject.is_own(element):
                yield Finding(
                    element, f"`<{element.tag}>` comes after `<worldbody>`", help="move it in front of the body tree"
                )
                return


@rule(
    "indentation",
    "A file that is not indented by two spaces",
    in_files=True,
    usual=False,
    profiles={
        "menagerie": "CONTRIBUTING, Code Style: use 2-space indentation",
    },
)
def indentation(subject: Subject) -> Found:
    unit = subject.unit
    text = None if unit is None else unit.origins.texts.get(unit.file)
    if unit is None or text is None:
        return
    for number, line in enumerate(text.split().text.split("\n"), 1):
        blank = line[: len(line) - len(line.lstrip())]
        if line.lstrip().startswith("<") and ("\t" in blank or len(blank) % 2):
            message = f"line {number} is not indented by two spaces for each level"
            yield Finding(subject.root, message, help=f"run `mjcompose fmt {unit.file}`")
            return
