"""What is behind the model.

The camera that has the whole model in its picture, and the light without which it would be dark. No OpenGL.

A model before a camera. Needs OpenGL, and skips where there is none.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.pictures import SKYLESS, camera, corners, has_sky, is_lit, over, prepared

DRAWN = np.array([[0.0, 0.5, 1.0]])
PICTURE = np.array([[[0, 0, 0], [50, 0, 0], [100, 0, 0]]], np.uint8)
"""A red thing of which the middle pixel is half full: MuJoCo has blended it with black."""


def test_edges_are_blended_with_the_background() -> None:
    assert over(PICTURE, DRAWN, (200, 200, 200, 1)).tolist() == [[[200] * 3, [150, 100, 100], [100, 0, 0]]]


def test_without_a_sky_it_is_light() -> None:
    assert over(PICTURE, DRAWN, None)[0, 0].tolist() == list(SKYLESS[:3])


def test_a_transparent_one_keeps_the_color_of_edges() -> None:
    assert over(PICTURE, DRAWN, (0, 0, 0, 0)).tolist() == [[[0, 0, 0, 0], [100, 0, 0, 128], [100, 0, 0, 255]]]


ASPECT = 4 / 3
MODELS = {
    "ball": '<geom size="0.1"/>',
    "far away": '<geom size="0.1" pos="10 -20 5"/>',
    "thin and long": '<geom type="box" size="3 0.01 0.01" euler="0 30 40"/>',
    "tall": '<geom type="capsule" size="0.05 4"/>',
    "near and far": '<geom size="0.5" pos="2 0 0"/><geom size="0.02" pos="-4 1 0"/>',
    "on a floor": '<geom type="plane" size="0 0 1"/><body pos="1 2 0.5"><geom size="0.3"/></body>',
    "a floor alone": '<geom type="plane" size="2 3 1"/>',
    "with what is not drawn": '<geom size="0.1"/><geom size="9" group="3"/><geom size="9" rgba="1 0 0 0"/>',
}


def _made(bodies: str, visual: str = "") -> tuple[mujoco.MjModel, mujoco.MjData]:
    text = f"<mujoco><visual>{visual}</visual><worldbody>{bodies}</worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def _seen(model: mujoco.MjModel, free: mujoco.MjvCamera, points: np.ndarray) -> np.ndarray:
    """The points in the picture: 1 is its right or upper border. By MuJoCo's own camera."""
    scene = mujoco.MjvScene(model, 10)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mujoco.mjv_updateScene(
        model, data, mujoco.MjvOption(), mujoco.MjvPerturb(), free, mujoco.mjtCatBit.mjCAT_ALL, scene
    )
    left, eye = scene.camera  # two eyes, between which a picture for one is taken
    right = np.cross(eye.forward, eye.up)
    away = points - (np.array(left.pos) + np.array(eye.pos)) / 2
    depth = away @ np.array(eye.forward)
    assert (depth > 0).all()
    high = math.tan(math.radians(model.vis.global_.fovy) / 2)
    return np.stack([away @ right / depth / high / ASPECT, away @ np.array(eye.up) / depth / high], axis=1)


@pytest.mark.parametrize("view", ["", '<global azimuth="20" elevation="-70" fovy="30"/>'], ids=["default", "asked for"])
@pytest.mark.parametrize("name", MODELS)
def test_all_of_the_model_is_in_the_picture_and_fills_it(name: str, view: str) -> None:
    model, data = _made(MODELS[name], view)
    free = camera(mujoco, [(model, data)], ASPECT)
    seen = _seen(model, free, corners(mujoco, model, data))
    assert np.abs(seen).max() <= 1
    assert np.abs(seen).max() > 0.85
    assert np.abs((seen.min(axis=0) + seen.max(axis=0)) / 2).max() < 0.1


def test_both_of_two_models_are_in_the_picture() -> None:
    first = _made(MODELS["ball"])
    second = _made(MODELS["far away"])
    free = camera(mujoco, [first, second], ASPECT)
    points = np.concatenate([corners(mujoco, *each) for each in (first, second)])
    assert np.abs(_seen(first[0], free, points)).max() <= 1


def test_a_model_without_anything_to_see_is_looked_at_as_mujoco_does() -> None:
    model, data = _made('<body pos="0 0 1"><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>')
    default = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, default)
    assert camera(mujoco, [(model, data)], ASPECT).distance == default.distance


@pytest.mark.parametrize(
    ("lamp", "headlight", "lit", "diffuse"),
    [
        ("", "", False, 0.6),
        ("", '<headlight active="0"/>', False, 0.6),
        ("", '<headlight diffuse="0.9 0.9 0.9"/>', False, 0.9),
        ('<light active="false"/>', '<headlight active="0"/>', False, 0.6),
        ("<light/>", "", True, 0.4),
    ],
)
def test_without_a_lamp_the_headlight_is_on(lamp: str, headlight: str, lit: bool, diffuse: float) -> None:
    model, _ = _made(f'{lamp}<geom size="0.1"/>', headlight)
    asked = model.vis.headlight
    before = asked.active, asked.ambient.tolist(), asked.diffuse.tolist(), model.vis.map.zfar
    assert is_lit(model) is lit
    with prepared(model, distance=1e4):
        assert asked.active == (before[0] or 1)
        assert asked.diffuse.tolist() == pytest.approx([diffuse] * 3)
        assert model.vis.map.zfar * model.stat.extent > 1e4
    assert (asked.active, asked.ambient.tolist(), asked.diffuse.tolist(), model.vis.map.zfar) == before


def test_a_sky_is_a_texture() -> None:
    assert not has_sky(mujoco, _made(MODELS["ball"])[0])
    text = '<mujoco><asset><texture type="skybox" builtin="flat" rgb1="1 1 1" width="8" height="8"/></asset></mujoco>'
    assert has_sky(mujoco, mujoco.MjModel.from_xml_string(text))


@pytest.mark.parametrize("view", ["", '<global azimuth="20" elevation="-60"/>'])
def test_a_robot_fills_the_picture_on_any_ground(view: str) -> None:
    """Height fields and planes are the ground on which it stands, however large they are."""
    hill = '<asset><hfield name="hill" nrow="2" ncol="2" elevation="0 1 1 0" size="10 10 1 .1"/></asset>'
    robot = '<body pos="0 0 1"><geom size=".1"/></body>'

    def made(ground: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
        text = f"<mujoco><visual>{view}</visual>{hill}<worldbody>{ground}</worldbody></mujoco>"
        model = mujoco.MjModel.from_xml_string(text)
        mujoco.mj_forward(model, data := mujoco.MjData(model))
        return model, data

    terrain = '<geom type="hfield" hfield="hill"/>'
    there = [
        camera(mujoco, [made(each + robot)], ASPECT) for each in ("", terrain, '<geom type="plane" size="50 50 1"/>')
    ]
    assert len({(each.distance, *each.lookat) for each in there}) == 1
    alone = camera(mujoco, [made(terrain)], ASPECT)
    assert alone.distance > 10


BALL = '<mujoco><worldbody><geom size="0.1" rgba="{rgba}"/></worldbody></mujoco>'


def middle_and_corner(mujoco: object, model: object, background: list[int] | None) -> dict[str, object]:
    """Runs in the child."""
    from mjcompose.mujoco.pictures import Look, NoOpenGL, Stage

    try:
        stage = Stage(mujoco, model, None, Look(64, 48, background and tuple(background)))
    except NoOpenGL as error:
        return {"no OpenGL": str(error)}
    picture = stage.picture(stage.whole())
    stage.close()
    return {"middle": picture[24, 32].tolist(), "corner": picture[0, 0].tolist()}


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    sys.path.insert(0, os.path.dirname(__file__))
    with Session(rendering=True) as session:
        yield session
    sys.path.remove(os.path.dirname(__file__))


@pytest.mark.parametrize("background", [None, [10, 200, 30, 1], [0, 0, 0, 0]])
@pytest.mark.parametrize("rgba", ["0.9 0.1 0.1 1", "0.02 0.02 0.02 1"])
def test_a_model_without_light_or_sky_can_be_seen(
    session: Session, background: list[int] | None, rgba: str, tmp_path: os.PathLike[str]
) -> None:
    from pathlib import Path

    folder = Path(tmp_path)
    (folder / "model.xml").write_text(BALL.format(rgba=rgba))
    assert engine.compile(folder, keep="ball", session=session).ok
    middle_and_corner.__module__ = "test_pictures"
    answer = engine.call(session, middle_and_corner, ["ball"], background)
    assert answer.ok, answer.error
    if "no OpenGL" in answer.value or session.no_opengl:
        pytest.skip("there is no OpenGL")
    middle = answer.value["middle"]
    corner = answer.value["corner"]
    expected = [235] * 3 if background is None else background[:3] if background[3] else [0, 0, 0, 0]
    assert corner == expected
    assert np.abs(np.array(middle[:3]) - corner[:3]).max() > 20 or len(corner) == 4
    if rgba.startswith("0.9"):
        assert middle[0] > 120 and middle[0] > 2 * middle[1]
