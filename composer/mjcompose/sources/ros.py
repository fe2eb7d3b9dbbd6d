"""Folders of `package://` in URDF, and choices for reading one."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Literal

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular

Visuals = Literal["keep", "drop"]
Fixed = Literal["keep", "fuse"]
Inertia = Literal["repair", "keep"]
Actuators = Literal["declared", "all", "none"]


class UrdfChoices(Struct):
    """Settings of a recipe for a URDF: `arguments` of a xacro template, and the choices of `urdf:`.

    None leaves the choice to the file or else to MuJoCo, which drops visuals and fuses fixed links.
    """

    arguments: tuple[tuple[str, str], ...] = ()
    visuals: Visuals | None = None
    fixed: Fixed | None = None
    actuators: Actuators = "declared"
    inertia: Inertia | None = None


AS_WRITTEN = UrdfChoices()


_REFERENCE = re.compile(r"(?:package|model):///*([^/\"'<>\s]+)/|\$\(find\s+([^)\s]+)\)")
_NAME = re.compile(rb"<name>\s*([^<\s]+)\s*</name>")
MANIFEST = "package.xml"
_NO_SOURCES = frozenset({"build", "install", "log", "node_modules"})
_DEPTH = 5


def packages_in(text: str) -> tuple[str, ...]:
    """Return the sorted names of the packages that a text refers to. No I/O."""
    return tuple(sorted({one or other for one, other in _REFERENCE.findall(text)}))


def folders(names: tuple[str, ...], urdf: Path, given: Mapping[str, Path]) -> dict[str, Path]:
    """Return the folder of each package: the given folder, or the nearest folder of that name above the file.

    The name in a folder's `package.xml` counts first. ROS keeps the description of a robot in the package that names
    its meshes.
    """
    known = all_folders(urdf, given)
    return {name: known[name] for name in names if name in known}


def all_folders(urdf: Path, given: Mapping[str, Path]) -> dict[str, Path]:
    """Every package that a file may name: given packages, and the folders above the file by all their names."""
    folders = Path(os.path.abspath(urdf)).parents[::-1]
    # A clone may have another name than its package.
    called = {name: folder for folder in folders if (name := _called(folder)) is not None}
    return {**{folder.name: folder for folder in folders}, **called, **given}


def in_workspace(folder: Path) -> Iterator[tuple[str, Path]]:
    """The packages in a folder and below, by their `package.xml`, sorted by path."""
    waiting = [(folder, 0)]
    while waiting:
        at, depth = waiting.pop(0)
        name = _called(at)
        if name is not None:
            yield name, at
            continue
        if depth < _DEPTH and not os.path.exists(at / "COLCON_IGNORE"):
            try:
                inner = sorted(child for child in at.iterdir() if os.path.isdir(child) and not child.is_symlink())
            except OSError:
                continue
            waiting += [
                (child, depth + 1)
                for child in inner
                if child.name not in _NO_SOURCES and not child.name.startswith(".")
            ]


def _called(folder: Path) -> str | None:
    manifest = folder / MANIFEST
    try:
        found = _NAME.search(read_regular(manifest)) if os.path.isfile(manifest) else None
    except OSError:
        return None
    return None if found is None else found[1].decode("utf-8", "replace")


def beside(name: str, urdf: Path) -> Path | None:
    """Return a folder of that name next to a folder above the file, as a suggestion."""
    neighbors = (folder / name for folder in Path(os.path.abspath(urdf)).parents)
    return next((folder for folder in neighbors if os.path.isdir(folder)), None)
