"""Where the files of a model are: MuJoCo's rules for folders, and the text of paths."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.tree.settings import Settings

_NOT_PLAIN = re.compile(r"//|/\.|^[./]|/$|[\\:]")
_TO_SHORTEN = re.compile(r"//|(^|/)\.\.?(/|$)|/$")
CUBE = ("fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")
NAMED_AFTER_FILE = ("mesh", "hfield", "skin", "texture")


def join(folder: str, name: str) -> str:
    """`name` in `folder`, shortened as text (`a/../b` is `b` whether or not `a` exists); backslashes part too."""
    if "\\" in name or "\\" in folder:
        name, folder = name.replace("\\", "/"), folder.replace("\\", "/")
    path = name if is_absolute(name) or not folder else f"{folder}/{name}"
    return posixpath.normpath(path) if _TO_SHORTEN.search(path) else path


def is_absolute(name: str) -> bool:
    return name.startswith("/") or name[1:3] == ":/"


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


def is_plain(name: str) -> bool:
    """Whether a path needs no shortening and stands for a file below the folder it is joined to."""
    return not _NOT_PLAIN.search(name)


def written_path(settings: Settings, element: Node, attribute: str) -> str:
    """The file as MuJoCo would look for it: relative to the folder of the main file unless absolute."""
    name = str(element.get(attribute))
    if settings.strippath == "true":
        name = posixpath.basename(name.replace("\\", "/"))
    return join(settings.texture_folder if element.tag == "texture" else settings.mesh_folder, name)


def stem(file: str) -> str:
    """The name MuJoCo gives an asset that has none: `x.y.obj` is `x.y`."""
    base = posixpath.basename(file.replace("\\", "/"))
    return base.rsplit(".", 1)[0] if "." in base else base
