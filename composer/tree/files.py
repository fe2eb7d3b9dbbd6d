"""Where the files of a model are: MuJoCo's rules for folders, and the text of paths."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

if TYPE_CHECKING:
    from composer.tree.unit import Unit

_MESH = ("mesh", "hfield", "skin", "flexcomp")
CUBE = ("fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")
NAMED_AFTER_FILE = ("mesh", "hfield", "skin", "texture")


def join(folder: str, name: str) -> str:
    """`name` in `folder`, shortened as text (`a/../b` is `b` whether or not `a` exists); backslashes part too."""
    if "\\" in name or "\\" in folder:
        name, folder = name.replace("\\", "/"), folder.replace("\\", "/")
    path = name if is_absolute(name) or not folder else f"{folder}/{name}"
    return posixpath.normpath(path) if "./" in path or "//" in path or path.endswith((".", "/")) else path


def is_absolute(name: str) -> bool:
    return name.startswith("/") or (len(name) > 2 and name[1] == ":" and name[2] == "/")


def file_attributes(root: Node) -> Iterator[tuple[Node, str]]:
    """Every element and attribute of a model that names a mesh, texture, height field, skin or flex file."""
    for section in root:
        if section.tag == "asset":
            for element in section.iterchildren("mesh", "texture", "hfield", "skin"):
                if element.get("file"):
                    yield element, "file"
                if element.tag == "texture":
                    yield from ((element, side) for side in CUBE if element.get(side))
        elif section.tag == "worldbody":
            yield from ((element, "file") for element in section.iter("flexcomp") if element.get("file"))
        elif section.tag == "deformable":
            yield from ((element, "file") for element in section.iterchildren("skin") if element.get("file"))


def written_path(unit: Unit, element: Node, attribute: str) -> str:
    """The file as MuJoCo would look for it: relative to the unit's directory unless absolute."""
    settings = unit.settings
    name = str(element.get(attribute))
    if settings.strippath == "true":
        name = posixpath.basename(name.replace("\\", "/"))
    folder = settings.texture_folder if element.tag == "texture" else settings.mesh_folder
    return join(folder, name)


def disk_path(unit: Unit, written: str) -> str:
    return join(str(unit.directory), written)


def stem(file: str) -> str:
    """The name MuJoCo gives an asset that has none: `x.y.obj` is `x.y`."""
    base = posixpath.basename(file.replace("\\", "/"))
    return base.rsplit(".", 1)[0] if "." in base else base
