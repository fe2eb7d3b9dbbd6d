from __future__ import annotations

import os
from typing import Any

import mujoco
import pytest
from mjcompose.mujoco.fit import NEEDS, make

pytestmark = pytest.mark.slow

CUBE = "0 0 0  1 0 0  0 1 0  1 1 0  0 0 1  1 0 1  0 1 1  1 1 1"
CUBE_FACES = "0 2 1 1 2 3  4 5 6 5 7 6  0 1 4 1 5 4  2 6 3 3 6 7  0 4 2 2 4 6  1 3 5 3 7 5"
# Three cubes that make an L.
ELL = """0 0 0  2 0 0  2 1 0  1 1 0  1 2 0  0 2 0  0 0 1  2 0 1  2 1 1  1 1 1  1 2 1  0 2 1"""
ELL_FACES = (
    "0 5 4 0 4 3 0 3 1 1 3 2  6 10 11 6 9 10 6 7 9 7 8 9  0 1 7 0 7 6  1 2 8 1 8 7  2 3 9 2 9 8"
    "  3 4 10 3 10 9  4 5 11 4 11 10  5 0 6 5 6 11"
)


def made(method: str, wanted: Any, most_faces: int = 10_000, **mesh: str) -> dict[str, Any]:
    for name in NEEDS[method]:
        pytest.importorskip(name.replace("-", "_"))
    return make(mujoco, {"mesh": mesh, "method": method, "wanted": wanted, "most_faces": most_faces})


def cube(scale: str = "1 1 1") -> dict[str, str]:
    return {"vertex": CUBE, "face": CUBE_FACES, "scale": scale}


def test_the_hull_of_a_cube_is_the_cube() -> None:
    found = made("hull", {"vertices": None}, **cube("1 2 3"))
    (shape,) = found["shapes"]
    assert sorted(map(tuple, shape["vertices"])) == [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)]
    assert len(shape["faces"]) == 12
    error = found["error"]
    assert (error["hausdorff"], error["uncovered"], error["volume"]) == (0, 0, 1)
    assert found["mesh"] == {"faces": 12, "closed": True, "size": 3.742, "mapped": False}


@pytest.mark.parametrize(
    ("primitive", "volume"), [("box", 6), ("sphere", 27.44), ("capsule", 17.63), ("cylinder", 10.21)]
)
def test_a_primitive_has_all_of_the_mesh_inside(primitive: str, volume: float) -> None:
    found = made("fit", primitive, **cube("1 2 3"))
    (shape,) = found["shapes"]
    assert shape["type"] == primitive
    assert found["error"]["short"] == 0 and found["error"]["uncovered"] == 0
    assert found["error"]["volume"] * 6 == pytest.approx(volume, rel=0.01)


def test_the_best_primitive_is_the_smallest() -> None:
    assert made("fit", "best", **cube("1 2 3"))["shapes"][0]["type"] == "box"
    ball = {"builtin": "sphere", "params": "4", "scale": "0.1 0.1 0.1"}
    found = made("fit", "best", **ball)
    assert found["shapes"][0]["type"] == "sphere"
    assert found["shapes"][0]["size"] == pytest.approx([0.1], rel=1e-3)
    assert found["error"]["hausdorff"] < 0.002


def test_a_hull_is_as_far_from_a_concave_mesh_as_the_corner_is_deep() -> None:
    found = made("hull", {"vertices": None}, vertex=ELL, face=ELL_FACES)
    # The hull goes from (2, 1) to (1, 2): the corner (1, 1) is half a diagonal behind that.
    assert found["error"]["beyond"] == pytest.approx(0.5, abs=0.02)
    assert found["error"]["short"] == 0
    assert found["error"]["volume"] == pytest.approx(3.5 / 3, rel=1e-3)


def test_pieces_are_nearer_than_the_hull_and_the_same_again() -> None:
    wanted = {"parts": 4, "threshold": 0.05, "vertices": 32, "seed": 1}
    one, other = (made("decompose", wanted, vertex=ELL, face=ELL_FACES) for _ in range(2))
    assert one == other
    assert len(one["shapes"]) == 2
    assert one["error"]["hausdorff"] < 0.05
    assert one["error"]["volume"] == pytest.approx(1, abs=0.05)


def test_balls_cover_the_surface() -> None:
    found = made("spheres", {"count": 5, "seed": 3}, **cube("1 2 3"))
    assert [shape["type"] for shape in found["shapes"]] == ["sphere"] * 5
    assert found["error"]["uncovered"] <= 0.01
    assert found == made("spheres", {"count": 5, "seed": 3}, **cube("1 2 3"))
    assert found["shapes"] != made("spheres", {"count": 5, "seed": 4}, **cube("1 2 3"))["shapes"]


def test_hulls_with_fewer_vertices_are_measured_as_smaller() -> None:
    ball = {"builtin": "sphere", "params": "4"}
    found = made("hull", {"vertices": 20}, **ball)
    assert len(found["shapes"][0]["vertices"]) <= 20
    assert found["error"]["short"] > 0.05 and found["error"]["uncovered"] > 0.5


def test_a_simpler_mesh_has_no_more_faces_and_stays_closed() -> None:
    ball = {"builtin": "sphere", "params": "4"}
    found = made("simplify", {"faces": 300}, **ball)
    (shape,) = found["shapes"]
    assert 100 < len(shape["faces"]) <= 300
    assert 0 < found["error"]["hausdorff"] < 0.1
    assert found["error"]["volume"] == pytest.approx(1, abs=0.1)


def test_a_mesh_with_few_faces_stays_as_it_is() -> None:
    found = made("simplify", {"faces": 300}, **cube())
    assert len(found["shapes"][0]["faces"]) == 12 and found["error"]["hausdorff"] == 0


def test_a_cube_cannot_be_torn() -> None:
    assert "without being torn" in made("simplify", {"faces": 5}, **cube())["unusable"]


def test_flat_and_broken_meshes_are_no_ground_for_shapes() -> None:
    flat = {"vertex": "0 0 0  1 0 0  0 1 0  1 1 0", "face": "0 1 2  1 3 2"}
    assert made("hull", {"vertices": None}, **flat)["unusable"] == "it is flat"
    assert "MuJoCo cannot read it" in made("fit", "box", file=os.devnull)["unusable"]


def test_the_faces_are_limited() -> None:
    found = made("hull", {"vertices": None}, 10, **cube())
    assert found == {"unusable": "it has 12 faces, and 10 are allowed", "limit": "mesh-faces"}


def test_an_open_mesh_has_no_volume() -> None:
    open_cube = {"vertex": CUBE, "face": CUBE_FACES.rpartition("  ")[0]}
    found = made("hull", {"vertices": None}, **open_cube)
    assert found["mesh"]["closed"] is False
    assert found["error"]["volume"] is None
    # Where the side is missing the hull is far from all of the surface.
    assert found["error"]["beyond"] == pytest.approx(0.45, abs=0.05)
