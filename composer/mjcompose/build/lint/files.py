"""Rules about assets and licenses."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.files import Refused
from mjcompose.build.lint.rule import Finding, Found, Subject, rule
from mjcompose.sources import license
from mjcompose.tree.cost import pixels
from mjcompose.tree.files import file_attributes, is_absolute, join, written_path
from mjcompose.tree.mesh_cost import file_points

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.tree.unit import Unit

_LARGE_TEXTURE = 4096 * 4096
_FINE_MESH = 200_000
_HEAVY = 5_000_000
_ASSET = {"robot-asset": "SPDX: each file that is passed on names its license"}


@rule("no-license", in_files=True, profiles={"menagerie": "each folder has a LICENSE", **_ASSET})
def license_missing(subject: Subject) -> Found:
    """A model without a license.

    Nobody may copy or change a model without a license, so it cannot become part of another one. A license is a file
    such as `LICENSE` next to the model or in a folder above it, or a line `SPDX-License-Identifier` in the model.

    ```xml
    <!-- SPDX-License-Identifier: Apache-2.0 -->
    <mujoco model="arm"> … </mujoco>
    ```

    Only models with meshes or with more than ten bodies count: a small test needs no license.
    """
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


@rule("absolute-path", profiles={"robot-asset": "references between files are relative (OpenUSD, SimReady)"})
def absolute_path(subject: Subject) -> Found:
    r"""A file named by a path that exists on one machine only.

    An absolute path, a drive letter or a backslash leads nowhere on the machines of other people and in CI.

    ```xml
    <mesh file="/home/me/meshes/link.stl"/>
    <mesh file="meshes\link.stl"/>
    ```

    Write a path relative to the model, with `/`.
    """
    places = [*file_attributes(subject.root)]
    places += [
        (each, name, str(each.get(name)))
        for each in subject.root.iterfind("compiler")
        for name in ("meshdir", "texturedir", "assetdir")
        if each.get(name)
    ]
    for element, attribute, value in places:
        if is_absolute(value) or "\\" in value or value[1:2] == ":":
            message = f"the path `{value}` exists on one machine or system only"
            yield Finding(element, message, attribute, help="write a path relative to the model, with `/`")


def _real(element: Node, value: str, unit: Unit) -> str | None:
    """Return the real path of a file that the model may read."""
    path = written_path(unit.settings, element, value)
    if path in unit.contents:
        return None
    try:
        return unit.door.admit(join(str(unit.directory), path))
    except (OSError, Refused):
        return None


def _assets(subject: Subject) -> Iterator[tuple[Node, str, str]]:
    """Yield element, attribute and real path of each file of the model."""
    if subject.unit is not None:
        for element, attribute, value in file_attributes(subject.root):
            real = _real(element, value, subject.unit)
            if real is not None and os.path.isfile(real):
                yield element, attribute, real


@rule("same-file-twice", in_files=True)
def same_file_twice(subject: Subject) -> Found:
    """Two files with the same bytes.

    Everybody who gets the model loads both, and a correction of one is forgotten in the other.

    ```xml
    <mesh name="left_pad" file="pad_left.stl"/>
    <mesh name="right_pad" file="pad_right.stl"/>   <!-- the same bytes -->
    ```

    Use one file; two meshes may name it. `mjcompose build --dedup` does that for a bundle. Files below 10 kB do not
    count.
    """
    sizes: dict[int, list[tuple[Node, str, str]]] = {}
    seen: set[str] = set()
    for element, attribute, real in _assets(subject):
        if real not in seen and (size := os.path.getsize(real)) > 10_000:
            sizes.setdefault(size, []).append((element, attribute, real))
            seen.add(real)
    for alike in sizes.values():
        first: dict[str, str] = {}
        for element, attribute, real in alike if len(alike) > 1 else ():
            with open(real, "rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            other = first.setdefault(digest, real)
            if other != real:
                message = f"`{os.path.basename(real)}` has the same bytes as `{os.path.basename(other)}`"
                yield Finding(element, message, attribute)


@rule("texture-too-large", in_files=True)
def texture_too_large(subject: Subject) -> Found:
    """A texture with more than 4096 × 4096 pixels.

    Each pixel takes three bytes of memory in each process and on the graphics card. Some cards and browsers show no
    larger texture. Training with cameras is slow with it.

    ```xml
    <texture type="2d" file="shell_8k.png"/>
    ```

    Write a smaller image: 1024 × 1024 is enough for the shell of a robot.
    """
    if subject.unit is None:
        return
    for element, attribute, _ in file_attributes(subject.root):
        if element.tag == "texture" and (count := pixels(element, attribute, subject.unit)) > _LARGE_TEXTURE:
            message = f"the image has {count / 1e6:.0f} million pixels, {3 * count / 1e6:.0f} MB in memory"
            yield Finding(element, message, attribute, help="write an image of at most 4096 × 4096 pixels")


@rule("mesh-too-fine", in_files=True)
def mesh_too_fine(subject: Subject) -> Found:
    """A mesh with more than 200,000 points.

    It takes long to load and to draw, and other programs refuse it: a binary STL of MuJoCo may have 200,000 faces.
    Scans and CAD exports are often like this.

    ```xml
    <mesh file="scan.obj"/>
    ```

    Reduce the mesh. In a recipe, `edit: {simplify: …}` does it and measures the distance to the original.
    """
    if subject.unit is None:
        return
    for element in subject.root.iterfind("asset/mesh"):
        if element.get("file") and (points := file_points(element, subject.unit)) > _FINE_MESH:
            message = f"the mesh has at least {points:,} points"
            yield Finding(element, message, "file", help="reduce it, for example with `edit: {simplify: …}`")


@rule("file-too-large", in_files=True, profiles={"menagerie": "meshes are small enough for git"})
def file_too_large(subject: Subject) -> Found:
    """A file of more than 5 MB.

    It makes each clone, each bundle and each start of a simulation slow. Usually it is text where a binary format is
    ten times smaller, or a mesh that is finer than any camera sees.

    ```xml
    <mesh file="base.obj"/>   <!-- 24 MB -->
    ```

    Save it as binary STL or MSH, or reduce it.
    """
    seen: set[str] = set()
    for element, attribute, real in _assets(subject):
        size = os.path.getsize(real)
        if size > _HEAVY and real not in seen:
            seen.add(real)
            message = f"`{os.path.basename(real)}` has {size / 1e6:.1f} MB"
            yield Finding(element, message, attribute, help="reduce it, or save it in a binary format")
