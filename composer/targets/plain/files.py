"""Pass: textures, height fields and skins are the files that they were, named from the folder of the text."""

from __future__ import annotations

import posixpath
from pathlib import Path
from typing import Any

from lxml.etree import _Element as Node

from composer.tree.files import file_attributes, join


def keep_files(root: Node, folder: Path, spec: Any) -> dict[str, bytes]:
    """Gives the files by their paths; those of meshes are written anew. Raises OSError."""
    files: dict[str, bytes] = {}
    for element, attribute, name in list(file_attributes(root)):
        if element.tag == "mesh":
            continue
        under = spec.texturedir if element.tag == "texture" else spec.meshdir
        path = join(under or "", posixpath.basename(name) if spec.strippath else name)
        element.set(attribute, path)
        files[path] = (folder / path).read_bytes()
    return files
