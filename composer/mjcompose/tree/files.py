"""The files of a model by MuJoCo's rules for folders, and the settings that these depend on."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.files import RECIPES
from mjcompose.base.naming import is_portable


class SourceSettings(NamedTuple):
    """The compiler settings of one source, as text; the defaults are MuJoCo's.

    If there are several `<compiler>` elements, the last written value of each attribute counts.
    """

    angle: str = "degree"
    eulerseq: str = "xyz"
    autolimits: str = "true"
    meshdir: str | None = None
    texturedir: str | None = None
    assetdir: str | None = None
    strippath: str = "false"
    inertiafromgeom: str = "auto"
    inertiagrouprange: str = "0 5"
    balanceinertia: str = "false"
    boundmass: str = "0"
    boundinertia: str = "0"
    settotalmass: str = "-1"
    fusestatic: str = "false"
    discardvisual: str = "false"
    alignfree: str = "false"
    fitaabb: str = "false"

    @property
    def mesh_folder(self) -> str:
        return self.meshdir if self.meshdir is not None else self.assetdir or ""

    @property
    def texture_folder(self) -> str:
        return self.texturedir if self.texturedir is not None else self.assetdir or ""


_KNOWN = frozenset(SourceSettings._fields)


def read_settings(root: Node) -> SourceSettings:
    """Return the settings of a whole `<mujoco>` tree."""
    pairs = (pair for compiler in root.iterchildren("compiler") for pair in compiler.items())
    written = {str(name): str(value).strip() for name, value in pairs if name in _KNOWN and value.strip()}
    return SourceSettings(**written)


def is_recipe(file: str) -> bool:
    """Return whether a `<model>` with this file attaches a recipe.

    >>> is_recipe("tools/gripper.yaml")
    True
    """
    return file.lower().endswith(RECIPES)


CUBE = ("fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")
NAMED_AFTER_FILE = ("mesh", "hfield", "skin", "texture")


def join(folder: str, name: str) -> str:
    """Return `name` in `folder`, normalized as text (`a/../b` is `b`, even without `a`). Backslashes also separate."""
    if "\\" in name or "\\" in folder:
        name = name.replace("\\", "/")
        folder = folder.replace("\\", "/")
    path = name if is_absolute(name) or not folder else f"{folder}/{name}"
    return posixpath.normpath(path) if _has_empty_steps(path) else path


def _has_empty_steps(path: str) -> bool:
    """Return whether `//`, `.`, `..` or a final `/` may need normalizing; also true for names that begin with a dot."""
    return "/." in path or "//" in path or path.startswith(".") or path.endswith("/")


def is_absolute(name: str) -> bool:
    return name.startswith("/") or name[1:3] == ":/"


def file_attributes(root: Node) -> Iterator[tuple[Node, str, str]]:
    """Yield element, attribute and value of every mesh, texture, height field, skin or flex file that a model names."""
    for section in root.iterchildren("asset", "worldbody", "deformable"):
        tags = NAMED_AFTER_FILE if section.tag == "asset" else ("skin",)
        elements = section.iter("flexcomp") if section.tag == "worldbody" else section.iterchildren(*tags)
        for element in elements:
            attributes = ("file", *CUBE) if element.tag == "texture" else ("file",)
            for attribute in attributes:
                name = element.get(attribute)
                if name:
                    yield element, attribute, name


def is_plain(name: str) -> bool:
    """Return whether a path needs no change on any system, and leads to a file below the folder it is joined to."""
    if "/" in name and (_has_empty_steps(name) or is_absolute(name)):
        return False
    return not (name.startswith(".") or "\\" in name) and is_portable(name)


def written_path(settings: SourceSettings, element: Node, name: str) -> str:
    """Return the path under which MuJoCo looks for a file: relative to the folder of the main file unless absolute."""
    if settings.strippath == "true":
        name = posixpath.basename(name.replace("\\", "/"))
    return join(settings.texture_folder if element.tag == "texture" else settings.mesh_folder, name)


def stem(file: str) -> str:
    """Return the name that MuJoCo gives an unnamed asset: `x.y` for `x.y.obj`."""
    base = file.replace("\\", "/").rpartition("/")[2] if "/" in file or "\\" in file else file
    name, dot, _ = base.rpartition(".")
    return name if dot else base


def in_archive(path: Path) -> tuple[Path, str] | None:
    """Return the file that a path treats as a folder, and the rest of the path."""
    archive = next((above for above in path.parents if os.path.isfile(above)), None)
    return None if archive is None else (archive, path.relative_to(archive).as_posix())


class FromFolder(Mapping[str, bytes | Path]):
    """The files of `contents` under the names that a model in `folder` uses.

    >>> FromFolder({"tools/blade.obj": b"...", "arm.obj": b"..."}, "tools").get("blade.obj")
    b'...'
    """

    def __init__(self, contents: Mapping[str, bytes | Path], folder: str) -> None:
        self._contents = contents
        self._folder = folder

    def __getitem__(self, name: str) -> bytes | Path:
        return self._contents[join(self._folder, name)]

    def __iter__(self) -> Iterator[str]:
        start = f"{self._folder}/" if self._folder else ""
        return (path.removeprefix(start) for path in self._contents if path.startswith(start))

    def __len__(self) -> int:
        return sum(1 for _ in self)
