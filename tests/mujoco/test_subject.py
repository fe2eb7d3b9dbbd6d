"""Subjects of pictures: elements, exploded parts, names."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco.pictures import camera, corners, draw_links, explode, points_of

MODEL = """<mujoco>
  <asset><hfield name="h" nrow="2" ncol="2" size="50 50 5 1" elevation="0 1 1 0"/></asset>
  <worldbody>
    <geom type="hfield" hfield="h"/>
    <body name="arm/base" pos="0 0 1"><geom name="arm/shell" type="box" size="0.1 0.1 0.5"/><site name="arm/end" pos="0 0 0.5"/>
      <body name="arm/tip" pos="0 0 0.6"><joint name="arm/turn"/><geom size="0.05"/>
        <body name="tool/base" pos="0 0 0.1"><geom name="tool/shell" size="0.05" pos="0 0 0.05"/></body>
      </body>
    </body>
    <body name="cube/cube" pos="1 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def placed() -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def size(points: Any) -> list[float]:
    return np.ptp(points, axis=0).round(6).tolist()


@pytest.mark.parametrize(
    ("kind", "name", "expected"),
    [
        ("body", "arm/tip", [0.1, 0.1, 0.25]),
        ("body", "tool/base", [0.1, 0.1, 0.1]),
        ("joint", "arm/turn", [0.1, 0.1, 0.25]),
        ("geom", "arm/shell", [0.2, 0.2, 1.0]),
    ],
)
def test_a_subject_is_an_element_with_the_bodies_on_it(
    placed: Any, kind: str, name: str, expected: list[float]
) -> None:
    assert size(points_of(mujoco, *placed, kind, name)) == expected


def test_a_site_is_in_the_middle_of_its_picture(placed: Any) -> None:
    view = camera(mujoco, [placed], 1.5, points_of(mujoco, *placed, "site", "arm/end"))
    np.testing.assert_allclose(view.lookat, placed[1].site_xpos[0], atol=0.05)


def test_the_ground_counts_only_if_all_is_ground(placed: Any) -> None:
    assert max(size(corners(mujoco, *placed))) < 3
    assert max(size(corners(mujoco, *placed, [0]))) == 100


def test_parts_move_apart_and_lines_lead_to_their_places(placed: Any) -> None:
    model, data = placed
    before = {name: data.body(name).xpos.copy() for name in ("arm/base", "arm/tip", "tool/base", "cube/cube")}
    ((start, end),) = explode(mujoco, model, data)
    moved = {name: data.body(name).xpos - place for name, place in before.items()}
    np.testing.assert_allclose(moved["arm/tip"], moved["arm/base"], err_msg="bodies of one part stay together")
    np.testing.assert_allclose(data.geom("tool/shell").xpos - data.body("tool/base").xpos, [0, 0, 0.05], atol=1e-9)
    assert (moved["tool/base"] - moved["arm/base"])[2] > 0.3 and moved["cube/cube"][0] > 0 > moved["arm/base"][0]
    np.testing.assert_allclose(end, data.body("tool/base").xpos)
    np.testing.assert_allclose(start, before["tool/base"] + moved["arm/base"])


def test_a_line_leads_from_a_part_to_its_place(placed: Any) -> None:
    scene = mujoco.MjvScene(placed[0], maxgeom=1)
    draw_links(mujoco, scene, [([0, 0, 0], [1, 0, 0]), ([0, 0, 0], [0, 1, 0])])
    assert scene.ngeom == 1, "no more fit"
