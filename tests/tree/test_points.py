"""What is counted in a file is never less than what MuJoCo makes of it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from mjcompose.tree import mesh_cost
from mjcompose.tree.mesh_cost import points_in

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")
SIDES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def stl(triangles: np.ndarray) -> bytes:
    rows = np.zeros(len(triangles), [("normal", "<3f4"), ("corners", "<9f4"), ("more", "<u2")])
    rows["corners"] = np.reshape(triangles, (-1, 9))
    return bytes(80) + np.uint32(len(triangles)).tobytes() + rows.tobytes()


CLOSED = stl(np.array([CORNERS[list(each)] for each in SIDES]))
OPEN = stl(np.random.default_rng(1).random((50, 3, 3)))
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
ODD = OBJ.replace("v ", "  v\t", 2).replace("\n", "\r\n", 3).replace("f 1", " f  1", 1)


def made(data: bytes, name: str) -> mujoco.MjModel:
    text = f'<mujoco><asset><mesh name="m" file="{name}"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>'
    return mujoco.MjModel.from_xml_string(text, {name: data})


@pytest.mark.parametrize(
    ("data", "name", "most"),
    [
        (CLOSED, "m.stl", 4),
        (OPEN, "m.stl", 150),
        (OBJ.encode(), "m.obj", 4),
        (ODD.encode(), "m.obj", 4),
        (OBJ.replace("\n", "\r").encode(), "m.obj", 4),
    ],
    ids=["closed STL", "open STL", "OBJ", "odd OBJ", "OBJ of an old Macintosh"],
)
def test_the_points_of_a_mesh(data: bytes, name: str, most: int) -> None:
    counted = points_in(data, name[-3:])
    assert made(data, name).nmeshvert <= counted <= most


def test_polygons_count_as_their_triangles(tmp_path: Path) -> None:
    few = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\n"
    assert points_in(few + b"f 1 2 3 4\n" * 100, "obj") == 100
    assert points_in(few + b"f 1 2 3\n" * 100, "obj") == 50
    assert points_in(few + b"f" + b" 1" * 20_000 + b"\n", "obj") == 20_000 // 2 - 1 + 20_000**2 // 4000


def test_a_file_that_is_looked_at_piece_by_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = points_in(OBJ.encode() * 50, "obj")
    monkeypatch.setattr("mjcompose.tree.mesh_cost._PIECE", 100)
    assert points_in(OBJ.encode() * 50, "obj") == whole == 200


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b"", "stl"),
        (b"", "obj"),
        (b"", "msh"),
        (b"solid x\n", "stl"),
        (b"\xff" * 40, "msh"),
        (b"v", "obj"),
        (b"f \n", "obj"),
    ],
)
def test_what_is_no_mesh(data: bytes, kind: str) -> None:
    assert points_in(data, kind) == 0


@given(
    st.lists(
        st.one_of(
            st.just("v 0 0 0"),
            st.integers(1, 40).map(lambda count: "f" + " 1" * count),
            st.sampled_from(
                ["f" + " 1" * 1500, "f  1 2 3 ", "", "vn 1 0 0", "v ", "v \rv \rv ", "f 1/2/3 2 3", "\r", " v 0 0 0"]
            ),
        ),
        max_size=30,
    )
)
def test_a_quick_look_at_an_obj_file_never_sees_fewer_points_than_there_are(lines: list[str]) -> None:
    data = "\n".join(lines).encode()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mesh_cost, "_SMALL", 0)
        most = mesh_cost.most_points_in(data, "obj")
    assert most is None or most >= mesh_cost.points_in(data, "obj")


def test_a_quick_look_leaves_a_long_face_open() -> None:
    assert mesh_cost.most_points_in(b"v 0 0 0\n" * 10_000 + b"f" + b" 1" * 1001 + b"\n", "obj") is None
