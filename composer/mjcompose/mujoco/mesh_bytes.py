"""The surface of a mesh in few bytes that compress well, for a page in the browser.

The bytes are a head of three uint32 (vertices, triangles, flags), six float32 (the least vertex and the step of each
axis) and, if `MAPPED`, two float32 of texture coordinates for each vertex. Then come differences in byte planes, which
means the lowest byte of all numbers, then the next byte:

- vertices: for each axis the zigzag differences to the vertex before, in two planes
- normals, unless `FLAT`: the differences of their two bytes (`octahedral`), in one plane each
- triangles: three numbers each, in as many planes as the flags say above `PLANES`. The first is the difference of first
  vertices to the triangle before. The second is the difference of the second vertex to the first, and the third the
  zigzag difference of the third vertex to the second.

Vertices are in Morton order, and triangles in the order of their first vertex, which is their least.
"""

from __future__ import annotations

from typing import Any

import numpy as np

MAPPED, FLAT, PLANES = 1, 2, 8
_BITS, _BITS_OF_LARGE, _LARGE = 14, 16, 2.0  # bits of a vertex, bits in a large mesh, its least size in meters
_FLAT_ANGLE, _FLAT_SHARE = 2.5, 0.95


def encoded(corners: Any, normals: Any, faces: Any, of_normals: Any, flat: Any, of_flat: Any) -> bytes:
    """Return the bytes of a mesh. `flat` are its texture coordinates, or None."""
    low, extent = corners.min(axis=0), float(np.ptp(corners, axis=0).max())
    step = extent / ((1 << (_BITS if extent <= _LARGE else _BITS_OF_LARGE)) - 1) or 1.0
    whole = np.rint((corners - low) / step).astype(np.uint64)
    is_flat, folded = _is_flat(corners, normals, faces, of_normals=of_normals), octahedral(normals)
    place = _morton(whole)
    key = place[faces.ravel()]
    if not is_flat:
        bytes_of = folded.astype(np.uint8).astype(np.uint64)
        key = key << np.uint64(16) | (bytes_of[:, 0] << np.uint64(8) | bytes_of[:, 1])[of_normals.ravel()]
    if flat is not None:
        ranks = np.unique(key, return_inverse=True)[1].ravel().astype(np.uint64)
        key = ranks * np.uint64(len(flat)) + of_flat.ravel().astype(np.uint64)
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    corner = faces.ravel()[first]
    triangles = _ordered(index.reshape(-1, 3), place[corner])
    differences = np.diff(whole[corner].astype(np.uint16), axis=0, prepend=np.uint16(0)).view(np.int16)
    found = [_planes(each, 2) for each in _zigzag(differences).view(np.uint16).T]
    if not is_flat:
        found += [np.diff(each, prepend=np.int8(0)).tobytes() for each in folded[of_normals.ravel()[first]].T]
    numbers = np.diff(triangles, axis=1, prepend=0)
    numbers[:, 0] = np.diff(triangles[:, 0], prepend=0)
    numbers[:, 2] = _zigzag(numbers[:, 2])
    count = max(1, (int(numbers.max(initial=0)).bit_length() + 7) // 8)
    flags = MAPPED * (flat is not None) | FLAT * is_flat | count << PLANES
    head = np.array([len(first), len(triangles), flags], np.uint32).tobytes()
    head += np.array([*low, step, step, step], np.float32).tobytes()
    if flat is not None:
        head += flat[of_flat.ravel()[first]].astype(np.float32).tobytes()
    return b"".join([head, *found, _planes(numbers.ravel(), count)])


def _is_flat(corners: Any, normals: Any, faces: Any, of_normals: Any) -> bool:
    """Return whether nearly all of a surface has the normals of its triangles, which needs no bytes."""
    ends = corners[faces].astype(float)
    across = np.cross(ends[:, 1] - ends[:, 0], ends[:, 2] - ends[:, 0])
    area = np.linalg.norm(across, axis=1)
    least = np.einsum("tkj,tj->tk", normals[of_normals], across).min(axis=1)
    near = least >= np.cos(np.radians(_FLAT_ANGLE)) * area
    return bool(area[near].sum() >= _FLAT_SHARE * area.sum())


def octahedral(directions: Any) -> Any:
    """Return unit vectors in two bytes each, by folding the sphere into a square."""
    length = np.abs(directions).sum(axis=1, keepdims=True)
    flat = directions[:, :2] / np.maximum(length, 1e-12)
    turned = (1 - np.abs(flat[:, ::-1])) * np.where(flat >= 0, 1, -1)
    folded = np.where(directions[:, 2:] < 0, turned, flat)
    return np.rint(np.clip(folded, -1, 1) * 127).astype(np.int8)


def _morton(whole: Any) -> Any:
    """Return for each row of three numbers below 2¹⁶ one number with their bits in turns: near places are near."""
    spread = whole.astype(np.uint64)
    for shift, mask in (
        (32, 0xFFFF00000000FFFF),
        (16, 0xFF0000FF0000FF),
        (8, 0xF00F00F00F00F00F),
        (4, 0xC30C30C30C30C3),
        (2, 0x249249249249249),
    ):
        spread = (spread | spread << np.uint64(shift)) & np.uint64(mask)
    return spread[:, 0] | spread[:, 1] << np.uint64(1) | spread[:, 2] << np.uint64(2)


def _ordered(triangles: Any, place: Any) -> Any:
    """Return triangles with their least vertex first, in its order, without those whose corners are in one place."""
    at = place[triangles]
    kept = triangles[(at[:, 0] != at[:, 1]) & (at[:, 1] != at[:, 2]) & (at[:, 0] != at[:, 2])].astype(np.int64)
    turned = np.take_along_axis(kept, (kept.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    return turned[np.lexsort(turned.T[::-1])]


def _zigzag(values: Any) -> Any:
    """Return small positive numbers for small differences of either sign."""
    return values << 1 ^ values >> (8 * values.itemsize - 1)


def _planes(values: Any, count: int) -> bytes:
    return b"".join((values >> (8 * each) & 255).astype(np.uint8).tobytes() for each in range(count))
