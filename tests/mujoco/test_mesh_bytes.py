"""The bytes of meshes for the page, read again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mjcompose.mujoco.mesh_bytes import FLAT, MAPPED, PLANES, encoded, octahedral

STEP = 1 / ((1 << 14) - 1)


def ball(rows: int) -> tuple[Any, Any, Any]:
    """Corners, normals and triangles of a smooth ball of radius 0.5."""
    u, v = np.meshgrid(np.linspace(0, np.pi, rows), np.linspace(0, 2 * np.pi, 2 * rows, endpoint=False), indexing="ij")
    normals = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1).reshape(-1, 3)
    at = np.arange(rows * 2 * rows).reshape(rows, 2 * rows)
    a, b, c, d = (each.ravel() for each in (at[:-1], np.roll(at[:-1], -1, 1), at[1:], np.roll(at[1:], -1, 1)))
    return 0.5 * normals, normals, np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])


def signed(values: Any) -> Any:
    return (values >> 1) ^ -(values & 1)


def decoded(blob: bytes) -> tuple[int, Any, Any, Any, Any]:
    """Flags, corners, normals, texture coordinates and triangles, as the page reads them."""
    count, triangles, flags = np.frombuffer(blob, np.uint32, 3).tolist()
    low, step = np.frombuffer(blob, np.float32, 6, 12).reshape(2, 3)
    at, flat, folded = 36, None, None
    if flags & MAPPED:
        flat = np.frombuffer(blob, np.float32, 2 * count, at).reshape(-1, 2)
        at += 8 * count
    bytes_of = np.frombuffer(blob, np.uint8, offset=at).astype(np.int64)
    planes = bytes_of[: 6 * count].reshape(3, 2, count)
    corners = low + step * (np.cumsum(signed(planes[:, 0] | planes[:, 1] << 8), axis=1) & 0xFFFF).T
    bytes_of = bytes_of[6 * count :]
    if not flags & FLAT:
        folded = np.cumsum(bytes_of[: 2 * count].reshape(2, count), axis=1).astype(np.uint8).view(np.int8).T
        bytes_of = bytes_of[2 * count :]
    shifts = 8 * np.arange(flags >> PLANES)
    numbers = (bytes_of.reshape(len(shifts), -1) << shifts[:, None]).sum(axis=0).reshape(-1, 3)
    first = np.cumsum(numbers[:, 0])
    second = first + numbers[:, 1]
    faces = np.stack([first, second, second + signed(numbers[:, 2])], axis=1)
    assert len(faces) == triangles
    return flags, corners, folded, flat, faces


def turned(triangles: Any) -> set[tuple[int, ...]]:
    """Triangles of grid points, each from its least corner on."""
    found = set()
    for each in np.rint(triangles / 1e-4).astype(int).tolist():
        first = min(range(3), key=lambda k: each[k])
        found.add(tuple(number for corner in each[first:] + each[:first] for number in corner))
    return found


@pytest.mark.parametrize("is_mapped", [False, True])
def test_a_smooth_surface_keeps_its_corners_normals_and_coordinates(is_mapped: bool) -> None:
    corners, normals, faces = ball(40)
    flat = corners[:, :2].astype(np.float32) if is_mapped else None
    flags, there, folded, mapped, triangles = decoded(
        encoded(corners, normals, faces, of_normals=faces, flat=flat, of_flat=faces if is_mapped else None)
    )
    assert not flags & FLAT and bool(flags & MAPPED) == is_mapped
    near = np.abs(there[:, None] - corners[None]).max(axis=2).argmin(axis=1)
    assert np.abs(there - corners[near]).max() <= STEP
    inner = np.abs(normals[near][:, 2]) < 0.999  # all corners of a pole are in one place
    assert np.abs(folded.astype(int) - octahedral(normals[near]))[inner].max() <= 1
    if is_mapped:
        assert np.abs(mapped - there[:, :2]).max() <= STEP
    # The triangles at the poles that have no area are left out.
    assert len(triangles) == len(faces) - 2 * 80
    across = np.cross(there[triangles[:, 1]] - there[triangles[:, 0]], there[triangles[:, 2]] - there[triangles[:, 0]])
    assert ((across * there[triangles[:, 0]]).sum(axis=1) > 0).all(), "triangles keep their direction"


def test_a_flat_surface_has_no_normals_and_shares_its_corners() -> None:
    box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = np.array(
        [
            [0, 1, 3],
            [0, 3, 2],
            [4, 6, 7],
            [4, 7, 5],
            [0, 4, 5],
            [0, 5, 1],
            [2, 3, 7],
            [2, 7, 6],
            [0, 2, 6],
            [0, 6, 4],
            [1, 5, 7],
            [1, 7, 3],
        ]
    )
    spread = box[faces].reshape(-1, 3)
    across = np.cross(spread[1::3] - spread[::3], spread[2::3] - spread[::3])
    own = np.arange(36).reshape(-1, 3)
    flags, there, folded, _, triangles = decoded(
        encoded(spread, np.repeat(across, 3, axis=0), own, of_normals=own, flat=None, of_flat=None)
    )
    assert flags & FLAT and folded is None and len(there) == 8
    assert turned(there[triangles]) == turned(box[faces])


def test_a_large_mesh_has_finer_steps() -> None:
    corners, normals, faces = ball(8)
    large = decoded(encoded(40 * corners, normals, faces, of_normals=faces, flat=None, of_flat=None))[1]
    assert np.abs(large[:, None] - 40 * corners[None]).max(axis=2).min(axis=1).max() <= 40 / 65535


def test_a_mesh_without_area_has_no_triangles() -> None:
    line = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 0]])
    faces = np.array([[0, 1, 2]])
    assert len(decoded(encoded(line, np.eye(3), faces, of_normals=faces, flat=None, of_flat=None))[4]) == 0
