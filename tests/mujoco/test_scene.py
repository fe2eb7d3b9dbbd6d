"""States of a model for the page: contacts, sensors, pulls; and the bytes of meshes, read again."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.scene import MAPPED, PLANES, UNSMOOTH, encoded, look, octahedral, poses, pull, seen

MODEL = """<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="box" pos="0 0 0.1"><freejoint/><geom name="box" type="box" size="0.1 0.1 0.1" mass="2"/><site name="s"/></body>
    <body name="arm" pos="1 0 1"><joint name="swing" axis="0 1 0" range="-90 90"/><geom size="0.05" pos="0.3 0 0" mass="1"/></body>
  </worldbody>
  <sensor><jointpos joint="swing"/><accelerometer site="s"/></sensor>
  <keyframe><key name="up" qpos="0 0 1 1 0 0 0 0.5"/></keyframe>
</mujoco>
"""


@pytest.fixture
def model() -> Any:
    return mujoco.MjModel.from_xml_string(MODEL)


def test_a_resting_box_has_the_contact_forces_of_its_weight(model: Any) -> None:
    data = mujoco.MjData(model)
    for _ in range(500):
        mujoco.mj_step(model, data)
    state = seen(mujoco, model, data)
    assert len(state["contacts"]) == 4 and {tuple(each[:2]) for each in state["contacts"]} == {(0, 1)}
    up = sum(each[10] for each in state["contacts"])
    assert up == pytest.approx(2 * 9.81, rel=1e-3), "on the second geom, upwards"
    assert all(each[5:8] == [0, 0, 1] for each in state["contacts"])
    assert state["sensors"] == pytest.approx(data.sensordata, rel=1e-4, abs=1e-4)


def test_each_keyframe_has_its_contacts_and_sensors(model: Any) -> None:
    reference, up = poses(mujoco, model, mujoco.MjData(model))
    assert len(reference["contacts"]) == 4 and up["contacts"] == []
    assert (reference["sensors"][0], up["sensors"][0]) == (0, 0.5)


def test_a_pose_is_looked_at_without_its_keyframe(model: Any) -> None:
    found = look(mujoco, model, {"qpos": [0, 0, 1, 1, 0, 0, 0, -0.25], "ctrl": []})
    assert found["contacts"] == [] and found["sensors"][0] == -0.25
    assert look(mujoco, model, {"qpos": [1, 2], "ctrl": []})["sensors"][0] == 0, "another model's pose is not taken"


def test_a_pulled_body_comes_to_the_point(model: Any) -> None:
    model.opt.gravity[:] = 0
    data = mujoco.MjData(model)
    to = [0.2, 0.1, 0.8]
    for _ in range(1500):
        data.xfrc_applied[:] = 0
        pull(mujoco, model, data, {"body": 1, "at": [0.1, 0.0, 0.0], "to": to})
        mujoco.mj_step(model, data)
    at = data.xpos[1] + data.xmat[1].reshape(3, 3) @ [0.1, 0, 0]
    np.testing.assert_allclose(at, to, atol=0.01)


@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"body": 0, "at": [0, 0, 0], "to": [1, 1, 1]},
        {"body": 9, "at": [0, 0, 0], "to": [1, 1, 1]},
        {"body": 1, "at": [0]},
    ],
)
def test_a_pull_of_nothing_does_nothing(model: Any, asked: dict[str, Any]) -> None:
    data = mujoco.MjData(model)
    pull(mujoco, model, data, asked)
    assert not data.xfrc_applied.any()


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
    at = 36
    flat = None
    folded = None
    if flags & MAPPED:
        flat = np.frombuffer(blob, np.float32, 2 * count, at).reshape(-1, 2)
        at += 8 * count
    bytes_of = np.frombuffer(blob, np.uint8, offset=at).astype(np.int64)
    planes = bytes_of[: 6 * count].reshape(3, 2, count)
    corners = low + step * (np.cumsum(signed(planes[:, 0] | planes[:, 1] << 8), axis=1) & 0xFFFF).T
    bytes_of = bytes_of[6 * count :]
    if not flags & UNSMOOTH:
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
    assert not flags & UNSMOOTH and bool(flags & MAPPED) == is_mapped
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
    assert flags & UNSMOOTH and folded is None and len(there) == 8
    assert turned(there[triangles]) == turned(box[faces])


def test_a_large_mesh_has_finer_steps() -> None:
    corners, normals, faces = ball(8)
    large = decoded(encoded(40 * corners, normals, faces, of_normals=faces, flat=None, of_flat=None))[1]
    assert np.abs(large[:, None] - 40 * corners[None]).max(axis=2).min(axis=1).max() <= 40 / 65535


def test_a_mesh_without_area_has_no_triangles() -> None:
    line = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 0]])
    faces = np.array([[0, 1, 2]])
    assert len(decoded(encoded(line, np.eye(3), faces, of_normals=faces, flat=None, of_flat=None))[4]) == 0
