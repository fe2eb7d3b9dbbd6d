"""Meshes that are made: an asset with its file, which is in memory until the bundle has it."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from typing import Any

from lxml.etree import _Element as Node

from composer.compose.editing import Editing
from composer.link.files import ASSETS
from composer.link.linking import FileUse
from composer.reading.door import held
from composer.tree.files import written_path

_NEUTRAL = {"scale": "1 1 1", "refpos": "0 0 0", "refquat": "1 0 0 0"}
_FILE_NAME = re.compile(r"[^\w.+-]")


def obj(shape: Mapping[str, Any]) -> bytes:
    r"""Vertices and faces as a file.

    >>> obj({"vertices": [[0, 0, 0], [1, 0, 0.5], [0, 1, 0]], "faces": [[0, 1, 2]]}).decode()
    'v 0 0 0\nv 1 0 0.5\nv 0 1 0\nf 1 2 3\n'
    """
    lines = [f"v {' '.join(f'{each:.7g}' for each in vertex)}" for vertex in shape["vertices"]]
    lines += [f"f {' '.join(str(corner + 1) for corner in face)}" for face in shape["faces"]]
    return ("\n".join(lines) + "\n").encode()


def write_file(editing: Editing, mesh: Node, name: str, key: str, shape: Mapping[str, Any]) -> None:
    """Give a mesh the shape as its file, where it stands as the shape says, whatever its class says of scales."""
    linking, unit = editing.linking, editing.linking.base
    content = obj(shape)
    # The key keeps it apart from every file that the model has.
    file = f"{_FILE_NAME.sub('_', name)}.{key[:8]}.obj"
    classes = dict.fromkeys(_NEUTRAL)
    for attribute in (*classes, "content_type", "vertex", "normal", "texcoord", "face", "builtin", "params"):
        mesh.attrib.pop(attribute, "")
    for attribute, neutral in _NEUTRAL.items():
        if (editing.effective(mesh, attribute) or neutral).split() != neutral.split():
            mesh.set(attribute, neutral)
    linking.files = [use for use in linking.files if use.element is not mesh]
    if editing.own:
        mesh.set("file", file)
        path = written_path(unit.settings, mesh, file)
        unit.contents = {**unit.contents, path: content}
        return
    folders, _, last = name.rpartition("/")
    path = f"{ASSETS}/{_folder(folders)}{_FILE_NAME.sub('_', last)}.{key[:8]}.obj"
    mesh.set("file", path)
    linking.files.append(
        FileUse(mesh, "file", path, source=held(os.path.join(unit.directory, path)), content=content)
    )


def _folder(names: str) -> str:
    steps = [_FILE_NAME.sub("_", each).strip(".") for each in names.split("/")]
    return "".join(f"{each}/" for each in steps if each)
