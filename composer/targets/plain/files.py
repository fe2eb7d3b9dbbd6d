"""Pass: keep textures, height fields and skins as they are, under paths relative to the folder of the text."""

from __future__ import annotations

import posixpath
from pathlib import Path
from typing import Any

from lxml.etree import _Element as Node

from composer.tree.files import file_attributes, join


def keep_files(root: Node, folder: Path, spec: Any) -> dict[str, bytes]:
    """Return the content of the files by path. Meshes are not among them: they are written anew. Raises OSError."""
    files: dict[str, bytes] = {}
    for element, attribute, name in list(file_attributes(root)):
        if element.tag == "mesh":
            continue
        under = spec.texturedir if element.tag == "texture" else spec.meshdir
        path = join(under or "", posixpath.basename(name) if spec.strippath else name)
        element.set(attribute, path)
        files[path] = (folder / path).read_bytes()
    return files
