"""Names in a picture: near their points, apart from each other, and inside of the picture."""

from __future__ import annotations

import itertools
import math
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.labels import Box, draw_line, projection, pushed_apart

ROOM = (0.0, 0.0, 400.0, 300.0)
MODEL = """<mujoco><visual><global fovy="60"/></visual><worldbody><geom name="near" pos="0 0 1" size="0.01"/>
<geom name="far" pos="0.3 -1 1.2" size="0.01"/><camera name="eye" pos="1 2 1.5" xyaxes="-1 0.4 0 0 0 1"/></worldbody></mujoco>"""


def meet(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


@pytest.mark.parametrize("count", [1, 2, 12, 40])
def test_names_of_one_place_stand_around_it(count: int) -> None:
    boxes = pushed_apart([(200.0, 150.0)] * count, [(60.0, 12.0)] * count, ROOM)
    assert not any(meet(one, other) for one, other in itertools.combinations(boxes, 2))
    assert all(0 <= left < right <= 400 and 0 <= top < bottom <= 300 for left, top, right, bottom in boxes)
    nearest = min(math.hypot((left + right) / 2 - 200, (top + bottom) / 2 - 150) for left, top, right, bottom in boxes)
    assert nearest < 40


def test_a_name_at_the_rim_stays_in_the_picture_and_too_many_names_are_all_there() -> None:
    ((left, top, right, bottom),) = pushed_apart([(399.0, 1.0)], [(80.0, 12.0)], ROOM)
    assert (right, top) == (400, 0) or (left >= 0 and right <= 400 and top >= 0 and bottom <= 300)
    assert len(pushed_apart([(5.0, 5.0)] * 9, [(10.0, 10.0)] * 9, (0.0, 0.0, 12.0, 12.0))) == 9


@pytest.mark.parametrize("name", [None, "eye"])
def test_a_point_is_where_mujoco_draws_it(name: str | None) -> None:
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    scene = mujoco.MjvScene(model, maxgeom=20)
    view = mujoco.MjvCamera()
    if name is None:
        mujoco.mjv_defaultFreeCamera(model, view)
    else:
        view.type = mujoco.mjtCamera.mjCAMERA_FIXED
        view.fixedcamid = 0
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, view, mujoco.mjtCatBit.mjCAT_ALL.value, scene)
    at = projection(scene, 640, 480)
    for geom in range(2):
        found = at(data.geom_xpos[geom])
        assert found is not None
        assert selected(model, data, scene, found) == geom
        assert selected(model, data, scene, (found[0] + 12, found[1])) == -1
        assert selected(model, data, scene, (found[0], found[1] + 12)) == -1
    assert at(scene.camera[0].pos - scene.camera[0].forward) is None, "it is behind the camera"


def selected(model: Any, data: Any, scene: Any, point: tuple[float, float]) -> int:
    """The geom that MuJoCo finds at a point of the picture."""
    geom = np.full(1, -1, np.int32)
    other = np.full(1, -1, np.int32)
    x = point[0] / 640
    y = 1 - point[1] / 480
    mujoco.mjv_select(model, data, mujoco.MjvOption(), 640 / 480, x, y, scene, np.zeros(3), geom, other, other.copy())
    return int(geom[0])


def test_a_line_is_drawn_in_the_picture_only() -> None:
    picture = np.zeros((4, 6, 4), np.uint8)
    draw_line(picture, (1, 1), (9, 1), (250, 100, 0))
    assert picture[1, :, 0].tolist() == [0, 250, 250, 250, 250, 250]
    assert picture[1, 1].tolist() == [250, 100, 0, 255] and not picture[[0, 2, 3]].any()
