"""Encode meshes and height fields: vertices as whole steps in their box, directions in two bytes."""

from __future__ import annotations

from typing import Any

import numpy as np

from composer.scene.blobs import Blobs, packed, short, steps


def meshes(model: Any, blobs: Blobs) -> list[str]:
    """Return the hash of each mesh's bytes.

    These are a head of three uint32 (vertices, triangles, whether there are texture coordinates) and six float32
    (the least vertex and the step), then vertices (three uint16 each), normals (two int8 each, octahedral), texture
    coordinates (two float32 each) and triangles (three uint32, or uint16 if there are fewer vertices than that).
    """
    return [_mesh(model, number, blobs) for number in range(model.nmesh)]


def _mesh(model: Any, number: int, blobs: Blobs) -> str:
    def rows(values: Any, first: Any, count: Any) -> Any:
        return values[int(first[number]) : int(first[number]) + int(count[number])]

    corners = rows(model.mesh_vert, model.mesh_vertadr, model.mesh_vertnum)
    normals = rows(model.mesh_normal, model.mesh_normaladr, model.mesh_normalnum)
    faces = rows(model.mesh_face, model.mesh_faceadr, model.mesh_facenum)
    of_normals = rows(model.mesh_facenormal, model.mesh_faceadr, model.mesh_facenum)
    flat, of_flat = None, None
    if model.mesh_texcoordadr[number] >= 0:
        flat = rows(model.mesh_texcoord, model.mesh_texcoordadr, model.mesh_texcoordnum)
        of_flat = rows(model.mesh_facetexcoord, model.mesh_faceadr, model.mesh_facenum)
    mapping = [] if flat is None else [flat, of_flat]
    return blobs.put(
        "mesh 1", [corners, normals, faces, of_normals, *mapping],
        lambda: _encoded(corners, normals, faces, of_normals=of_normals, flat=flat, of_flat=of_flat),
    )  # fmt: skip


def _encoded(corners: Any, normals: Any, faces: Any, of_normals: Any, flat: Any, of_flat: Any) -> bytes:
    index, (corner, normal, *texture) = _unified([faces, of_normals, *([] if flat is None else [of_flat])])
    whole, low, step = steps(corners)
    triangles = index.astype(np.uint16 if len(corner) <= 1 << 16 else np.uint32)
    return packed(
        np.array([len(corner), len(faces), flat is not None], np.uint32),
        np.array([*low, *step], np.float32),
        whole[corner],
        _octahedral(normals[normal]),
        *([] if flat is None else [flat[texture[0]].astype(np.float32)]),
        triangles,
    )


def _unified(faces: list[Any]) -> tuple[Any, list[Any]]:
    """Return one number for each combination of vertex, normal and texture coordinate that a triangle uses.

    The result has the triangles in these numbers, and for each number the rows of vertices, normals and texture
    coordinates.
    """
    flat = [each.ravel().astype(np.int64) for each in faces]
    if all((each == flat[0]).all() for each in flat[1:]):
        used = np.arange(int(flat[0].max()) + 1 if len(flat[0]) else 0)
        return flat[0], [used] * len(flat)
    key = flat[0]
    for each in flat[1:]:
        key = key * (int(each.max()) + 1) + each
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    return index.ravel(), [each[first] for each in flat]


def _octahedral(directions: Any) -> Any:
    """Return unit vectors in two bytes each, by folding the sphere into a square."""
    length = np.abs(directions).sum(axis=1, keepdims=True)
    flat = directions[:, :2] / np.maximum(length, 1e-12)
    turned = (1 - np.abs(flat[:, ::-1])) * np.where(flat >= 0, 1, -1)
    folded = np.where(directions[:, 2:] < 0, turned, flat)
    return np.rint(np.clip(folded, -1, 1) * 127).astype(np.int8)


def height_fields(model: Any, blobs: Blobs) -> list[dict[str, Any]]:
    """Return each height field: rows times columns of uint16, where 65535 is its full height."""
    found = []
    for number in range(model.nhfield):
        rows, columns, first = (
            int(each[number]) for each in (model.hfield_nrow, model.hfield_ncol, model.hfield_adr)
        )
        heights = model.hfield_data[first : first + rows * columns]

        def encode(heights: Any = heights) -> bytes:
            return packed(np.rint(np.clip(heights, 0, 1) * 65535).astype(np.uint16))

        blob = blobs.put("heights 1", [heights], encode)
        size = short(model.hfield_size[number])
        found.append({"blob": blob, "rows": rows, "columns": columns, "size": size})
    return found
