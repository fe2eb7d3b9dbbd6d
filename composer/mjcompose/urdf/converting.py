"""Runs in the child process: convert meshes that MuJoCo does not read to OBJ, and measure others.

Each material becomes an OBJ of its own, with its texture, and all of them together one OBJ, for shapes that collide.
"""

from __future__ import annotations

import base64
import io
import os
import warnings
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from mjcompose.base.access import Door
from mjcompose.base.files import Refused
from mjcompose.mujoco.shapes import measures

_Y_UP = ((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1))
"""In glTF 2.0 +Y is up (section 3.4). Drake 1.51 and RViz 2 since 2025 turn it like this."""
_FEWEST = 4
"""MuJoCo needs at least these vertices in a mesh."""


def convert(mujoco: Any, argument: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the parts of each file, or the reason that there are none: `missing` (a package), `error`, `refused`.

    With parts come the `measures` of all of them together, and the OBJ of the `whole`, None if there is one part.
    """
    door = Door(tuple(argument["roots"]), sees_all=argument["sees_all"])
    return [_one(path, door) for path in argument["files"]]


def _one(path: str, door: Door) -> dict[str, Any]:
    suffix = path.rpartition(".")[2].lower()
    if suffix == "stl":
        return _own(path, door)
    resolver = _Resolver(os.path.dirname(path), door)
    try:
        scene = _loaded(path, suffix, door, resolver)
    except Refused as refused:
        return {"refused": refused.path}
    except ImportError as error:
        return {"missing": error.name or "pycollada"}
    except OSError as error:
        return {"unreadable": (error.strerror or str(error)).lower()}
    except Exception as error:  # whatever a library finds wrong with a file
        name = type(error).__name__
        return {"error": (str(error).strip().partition("\n")[0].removeprefix(f"{name}: ") or name)[:160]}
    scale = _meters(scene)
    surfaces = [(mesh, surface) for mesh in _meshes(scene, suffix) if (surface := _surface(mesh, scale)) is not None]
    files = [file for file in resolver.read if os.path.isfile(file)]
    if resolver.refused:
        return {"refused": resolver.refused[0]}
    parts = [_part(mesh.visual, *surface) for mesh, surface in surfaces]
    return {"parts": parts, "files": files, "lost": resolver.lost, **_together([surface for _, surface in surfaces])}


def _loaded(path: str, suffix: str, door: Door, resolver: _Resolver) -> Any:
    """Return the scene of a file, without textures if it has no shapes with them."""
    import trimesh

    data = door.read(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        options: dict[str, Any] = {"split_objects": False, "group_material": True} if suffix == "obj" else {}
        options |= {"file_type": suffix, "resolver": resolver, "process": False, "maintain_order": True}
        load: Any = trimesh.load_scene
        scene = load(io.BytesIO(data), **options)
        plain = _without_textures(data) if suffix == "dae" and not scene.geometry else None
        if plain is not None:
            scene = load(io.BytesIO(plain), **options)
            resolver.lost.append("a texture")
    return scene


def _together(surfaces: list[tuple[Any, Any]]) -> dict[str, Any]:
    """Return the measures of surfaces as one, and their OBJ if there are several."""
    import numpy

    if not surfaces:
        return {"measures": None, "whole": None}
    starts = numpy.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    vertices = numpy.concatenate([vertices for vertices, _ in surfaces])
    faces = numpy.concatenate([faces + start for start, (_, faces) in zip(starts, surfaces, strict=False)])
    whole = _obj(vertices, faces, None) if len(surfaces) > 1 else None
    return {"measures": measures(vertices, faces), "whole": whole}


def _without_textures(data: bytes) -> bytes | None:
    """Read Collada without textures, because pycollada loses a mesh whose picture is not declared."""
    from lxml import etree

    root = etree.fromstring(data, etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True))
    textures = list(root.iter("{*}texture"))
    for element in [*textures, *root.iter("{*}newparam")]:
        holder = element.getparent()
        if holder is not None:
            if element in textures:
                etree.SubElement(holder, f"{{{etree.QName(element).namespace}}}color").text = "0.7 0.7 0.7 1"
            holder.remove(element)
    return etree.tostring(root) if textures else None


def _own(path: str, door: Door) -> dict[str, Any]:
    """Read an STL file that MuJoCo does not read: as text, or with too many faces."""
    import numpy

    try:
        vertices, faces = _stl(door.read(path))
    except Refused as refused:
        return {"refused": refused.path}
    except OSError as error:
        return {"unreadable": (error.strerror or str(error)).lower()}
    except (ValueError, IndexError) as error:
        return {"error": str(error)[:200]}
    if not len(faces) or not numpy.isfinite(vertices).all():
        return {"parts": [], "files": [], "lost": [], **_together([])}
    part = {"obj": _obj(vertices, faces, None), "rgba": None, "texture": None}
    return {"parts": [part], "files": [], "lost": [], **_together([(vertices, faces)])}


class _Resolver:
    def __init__(self, folder: str, door: Door) -> None:
        self.folder = folder
        self.door = door
        self.read: list[str] = []
        self.refused: list[str] = []
        self.lost: list[str] = []

    def get(self, name: str) -> bytes:
        path = os.path.normpath(os.path.join(self.folder, name.removeprefix("file://").replace("\\", "/")))
        try:
            data = self.door.read(path)
        except Refused:
            self.refused.append(path)
            raise
        except OSError:
            self.lost.append(name)
            raise
        self.read.append(path)
        return data

    __getitem__ = get


def _meters(scene: Any) -> float:
    """Return the unit of the file in meters: only Collada has another unit."""
    units = (str(mesh.metadata.get("units") or "") for mesh in scene.geometry.values())
    try:
        return float(next((text for text in units if text.endswith("* meters")), "1").removesuffix("* meters"))
    except ValueError:
        return 1.0


def _meshes(scene: Any, suffix: str) -> Iterator[Any]:
    """Yield the meshes in the frame of their link, in the scene's order, without lines and points."""
    import numpy

    upright = numpy.array(_Y_UP) if suffix in ("glb", "gltf") else numpy.eye(4)
    for name in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        if hasattr(mesh, "faces") and len(mesh.faces):
            mesh = mesh.copy()
            mesh.apply_transform(upright @ matrix)
            yield mesh


def _surface(mesh: Any, scale: float) -> tuple[Any, Any] | None:
    """Return the vertices of a mesh in meters, and its faces; None if it has no place."""
    import numpy

    vertices = numpy.asarray(mesh.vertices, float) * scale
    if not numpy.isfinite(vertices).all() or not len(vertices):
        return None
    return vertices, numpy.asarray(mesh.faces)


def _part(visual: Any, vertices: Any, faces: Any) -> dict[str, Any]:
    uv: Any = getattr(visual, "uv", None) if getattr(visual, "kind", None) == "texture" else None
    rgba, texture = _look(visual)
    if uv is not None and (texture is None or len(uv) != len(vertices)):
        uv = None
    encoded = None if texture is None else base64.b64encode(texture).decode("ascii")
    return {"obj": _obj(vertices, faces, uv), "rgba": rgba, "texture": encoded}


def _look(visual: Any) -> tuple[list[float] | None, bytes | None]:
    """Return the color and the picture (PNG) of a mesh, if it has them."""
    import numpy

    material = getattr(visual, "material", None)
    if material is None:
        if not getattr(visual, "defined", False):
            return None, None
        return [round(float(share), 4) for share in numpy.asarray(visual.main_color, float) / 255], None
    picture = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    colors = (getattr(material, name, None) for name in ("baseColorFactor", "diffuse"))
    color = next((color for color in colors if color is not None), None)
    rgba = None
    if color is not None:
        numbers = numpy.asarray(color, float).ravel()
        numbers = numbers / 255 if numpy.asarray(color).dtype.kind in "iu" or numbers.max(initial=0) > 1 else numbers
        rgba = [round(float(share), 4) for share in (*numbers[:3], numbers[3] if len(numbers) > 3 else 1.0)]
    if picture is None:
        return rgba, None
    content = io.BytesIO()
    picture.convert("RGB").save(content, "PNG", optimize=False)
    return rgba, content.getvalue()


def _obj(vertices: Any, faces: Any, uv: Any) -> str:
    """Return a mesh as OBJ; corners with the same place and the same point of the picture are merged."""
    import numpy

    columns = vertices if uv is None else numpy.hstack([vertices, uv[:, :2]])
    rows = columns.astype(numpy.float32)  # the precision of MuJoCo
    _, first, same = numpy.unique(rows, axis=0, return_index=True, return_inverse=True)
    order = numpy.argsort(numpy.argsort(first))
    rows = rows[numpy.sort(first)]
    faces = order[same.ravel()][faces] + 1
    if len(rows) < _FEWEST:
        rows = numpy.concatenate([rows, numpy.repeat(rows[-1:], _FEWEST - len(rows), axis=0)])
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in rows[:, :3].tolist()]
    if uv is None:
        lines += [f"f {a} {b} {c}" for a, b, c in faces.tolist()]
    else:
        lines += [f"vt {u:.9g} {v:.9g}" for u, v in rows[:, 3:].tolist()]
        lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in faces.tolist()]
    return "\n".join(lines) + "\n"


def measure(mujoco: Any, argument: dict[str, Any]) -> list[dict[str, Any] | None]:
    """Return the measures of each STL or OBJ file, or None if it cannot be read, which MuJoCo reports."""
    door = Door(tuple(argument["roots"]), sees_all=argument["sees_all"])
    found: list[dict[str, Any] | None] = []
    for path in argument["files"]:
        try:
            read = _READ.get(path.rpartition(".")[2].lower())
            found.append(None if read is None else measures(*read(door.read(path))))
        except (OSError, ValueError, IndexError, MemoryError):
            found.append(None)
    return found


def _stl(data: bytes) -> tuple[Any, Any]:
    import numpy

    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else 0
    if len(data) == 84 + 50 * count and count:
        rows = numpy.frombuffer(data, numpy.uint8, offset=84).reshape(count, 50)[:, 12:48]
        vertices = numpy.ascontiguousarray(rows).view("<f4").reshape(-1, 3).astype(float)
    else:
        words = [line.split()[1:4] for line in data.decode("ascii").splitlines() if line.strip().startswith("vertex")]
        vertices = numpy.array(words, float)
    return vertices, numpy.arange(len(vertices)).reshape(-1, 3)


def _wavefront(data: bytes) -> tuple[Any, Any]:
    import numpy

    vertices = []
    faces = []
    for line in data.decode("utf-8", "replace").splitlines():
        if line.startswith("v "):
            vertices.append(line.split()[1:4])
        elif line.startswith("f "):
            corners = [int(each.partition("/")[0]) for each in line.split()[1:]]
            corners = [each - 1 if each > 0 else len(vertices) + each for each in corners]
            faces += [(corners[0], a, b) for a, b in pairwise(corners[1:])]
    return numpy.array(vertices, float), numpy.array(faces, int)


_READ = {"stl": _stl, "obj": _wavefront}
