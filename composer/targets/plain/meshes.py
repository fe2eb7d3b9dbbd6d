"""Pass: write every mesh as an OBJ file with the vertices of MuJoCo's compiled mesh, in its own frame.

MuJoCo's compiler moves each mesh into a frame of its own, and its geoms accordingly. With these vertices and geoms,
a program that uses files unchanged sees the same surface.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from lxml.etree import _Element as Node

FOLDER = "assets"
_GONE = (
    "file", "content_type", "vertex", "normal", "texcoord", "face", "refpos", "refquat", "scale", "smoothnormal",
    "builtin", "params",
)  # fmt: skip
_NOT_IN_FILES = re.compile(r"[^A-Za-z0-9_.-]+")


def write_meshes(root: Node, model: Any, names: list[str]) -> dict[str, bytes]:
    """Make each mesh name its file, and return the files by path. `names` are those of the compiled meshes."""
    ids = {name: number for number, name in enumerate(names)}
    files: dict[str, bytes] = {}
    for mesh in root.iterfind("asset/mesh"):
        number = ids[mesh.get("name") or _stem(str(mesh.get("file")))]
        if next(mesh.iterchildren("plugin"), None) is not None:
            continue  # a plugin makes its surface
        mesh.set("name", names[number])
        for attribute in _GONE:
            mesh.attrib.pop(attribute, "")
        path = _free(f"{FOLDER}/{_NOT_IN_FILES.sub('_', names[number])}", files)
        mesh.set("file", path)
        files[path] = obj(model, number)
    return files


def obj(model: Any, number: int) -> bytes:
    """Return a mesh of a compiled model as an OBJ file."""
    return ("\n".join(_lines(model, number)) + "\n").encode()


def _lines(model: Any, number: int) -> Iterator[str]:
    vertices = _run(model.mesh_vert, model.mesh_vertadr[number], model.mesh_vertnum[number])
    normals = _run(model.mesh_normal, model.mesh_normaladr[number], model.mesh_normalnum[number])
    faces = slice(model.mesh_faceadr[number], model.mesh_faceadr[number] + model.mesh_facenum[number])
    corners = [model.mesh_face[faces], model.mesh_facenormal[faces]]
    yield from ("v {:.9g} {:.9g} {:.9g}".format(*each) for each in vertices.tolist())
    if model.mesh_texcoordadr[number] >= 0:
        coordinates = _run(
            model.mesh_texcoord, model.mesh_texcoordadr[number], model.mesh_texcoordnum[number]
        )
        # MuJoCo flips the second texture coordinate of OBJ files.
        yield from (f"vt {u:.9g} {np.float32(1) - np.float32(v):.9g}" for u, v in coordinates.tolist())
        corners.insert(1, model.mesh_facetexcoord[faces])
    yield from ("vn {:.9g} {:.9g} {:.9g}".format(*each) for each in normals.tolist())
    between = "/" if len(corners) == 3 else "//"
    for face in np.stack(corners, axis=-1) + 1:
        yield "f " + " ".join(between.join(map(str, corner)) for corner in face.tolist())


def _run(array: Any, start: int, count: int) -> Any:
    return array[start : start + count]


def _stem(file: str) -> str:
    name = file.replace("\\", "/").rpartition("/")[2]
    return name.rpartition(".")[0] or name


def _free(path: str, files: dict[str, bytes]) -> str:
    taken = {each.casefold() for each in files}
    number, found = 1, f"{path}.obj"
    while found.casefold() in taken:
        number, found = number + 1, f"{path}_{number + 1}.obj"
    return found
