"""Find the files that included MJCF names, which MuJoCo also looks for next to the including file's folder."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from lxml.etree import _Element as Node

from composer.reading.folders import files_among
from composer.tree.files import file_attributes, is_absolute, join, written_path
from composer.tree.unit import Unit

_BESIDE_FIRST = ("flexcomp", "model")


def find_beside(unit: Unit, included: Mapping[Node, Path]) -> None:
    """Rewrite file names in included elements, each given with the folder of its file, if MuJoCo finds them there.

    MuJoCo does so if the path of the main file is absolute; with a relative path it does not find them.
    """
    if unit.settings.strippath == "true":
        return
    directory = str(unit.directory)
    models = [(each, "file", str(each.get("file") or "")) for each in unit.root.iterfind("asset/model")]
    places: list[tuple[Node, str, str, str]] = []
    for element, attribute, name in [*file_attributes(unit.root), *models]:
        folder = included.get(element)
        if folder is None or not name or is_absolute(name) or name in unit.contents:
            continue
        usual = name if element.tag == "model" else written_path(unit.settings, element, name)
        there, beside = join(directory, usual), join(str(folder), name)
        if there != beside and usual not in unit.contents:
            places.append((element, attribute, there, beside))
    found = {path for _, paths in files_among(there for _, _, there, _ in places) for path in paths}
    for element, attribute, there, beside in places:
        wins = element.tag in _BESIDE_FIRST or not (there in found or os.path.exists(there))
        if wins and os.path.exists(beside):
            element.set(attribute, _from(_folder(unit, element), beside))


def _folder(unit: Unit, element: Node) -> str:
    """Return the folder that a file's path is joined to."""
    inner = {"model": "", "texture": unit.settings.texture_folder}
    return join(str(unit.directory), inner.get(str(element.tag), unit.settings.mesh_folder) or ".")


def _from(folder: str, path: str) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # on another drive
        return path
