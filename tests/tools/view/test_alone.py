"""A page that stands alone, in a real browser."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of

pytestmark = pytest.mark.slow
MODEL = """<mujoco>
  <worldbody>
    <body name="slid" pos="0.1 0 0" euler="10 20 30">
      <joint name="slide" type="slide" axis="1 2 0.5" pos="0.1 0 0" ref="0.05" range="-0.2 0.3"/>
      <geom name="box" type="box" size="0.1 0.2 0.3"/>
      <body name="turned" pos="0 0.2 0.1" quat="1 0.2 0.3 0">
        <joint name="first" axis="0 1 0.3" pos="0.05 0.02 0.1" range="-90 90" ref="20"/>
        <joint name="second" axis="1 0 0" pos="0 0.1 0"/>
        <geom size="0.05"/>
        <body name="rolled" pos="0.1 0.1 0.1"><joint name="ball" type="ball" pos="0.02 0.03 0.01"/><geom size="0.05"/></body>
      </body>
    </body>
    <body name="free" pos="1 2 3" euler="40 0 0"><freejoint name="free"/><geom size="0.1"/></body>
    <body name="led" mocap="true" pos="-1 0 0" euler="0 30 0"><geom size="0.02"/></body>
  </worldbody>
  <actuator><position name="push" joint="slide" ctrlrange="-1 1"/></actuator>
  <keyframe><key name="home" qpos="0.1 0.2 0.3 1 0 0 0 1 1 1 1 0 0 0" ctrl="0.4"/></keyframe>
</mujoco>
"""
PLACES = "() => ({pos: Array.from(mjcompose.world.pose.pos), quat: Array.from(mjcompose.world.pose.quat)})"


def placed(mujoco: Any, model: Any, configurations: list[list[float]]) -> list[Any]:
    """Where MuJoCo has bodies. Runs in the child."""
    data = mujoco.MjData(model)
    found = []
    for qpos in configurations:
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        found.append([data.xpos.ravel().tolist(), data.xquat.ravel().tolist()])
    return found


placed.__module__ = "tools.view.test_alone"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    (tmp_path / "model.xml").write_text(MODEL)
    return tmp_path


CHAIN = """<mujoco>
  <worldbody>
    <body name="near"><geom size="0.1"/>
      <body name="next" pos="0.5 0 0"><joint name="hinge" axis="0 1 0" range="-20 20"/><geom size="0.1"/>
        <body name="far" pos="0.5 0 0"><joint name="more" axis="0 1 0" range="-20 20"/><geom size="0.1"/></body>
      </body>
    </body>
    <body name="free" pos="1 2 3"><freejoint name="free"/><geom size="0.1"/></body>
  </worldbody>
</mujoco>
"""
EXCLUDING = """recipe: 1
base: ./model.xml
contact:
  exclude:
    - {body1: near, body2: free}
    - auto
"""


def test_excluded_contacts_stand_in_the_tree_and_beside_their_bodies_with_the_reason(
    model: Path, open_page: Callable[..., Any]
) -> None:
    (model / "model.xml").write_text(CHAIN)
    (model / "recipe.yaml").write_text(EXCLUDING)
    with Session() as session:
        page = open_page(page_of("recipe.yaml", model, session).as_uri())
    page.get_by_text("excluded contacts").click()
    page.get_by_text("near – far").click()
    reason = "they touched in none of 1000 random poses (seed 0) recipe.yaml:6"
    rows = page.locator(".info .changes li").all_inner_texts()
    assert {" ".join(each.split()) for each in rows} == {
        "free written in the recipe recipe.yaml:5",
        "next a joint connects them recipe.yaml:6",
        f"far {reason}",
    }


def _same(page: Any, session: Session) -> None:
    """Whether the page has bodies where MuJoCo has them."""
    qpos = page.evaluate("Array.from(mjcompose.world.pose.qpos)")
    answer = engine.call(session, placed, ["page"], [qpos])
    assert answer.ok, answer.error
    pos, quat = answer.value[0]
    there = page.evaluate(PLACES)
    assert np.abs(np.array(pos) - there["pos"]).max() < 1e-6
    quats = np.array(quat).reshape(-1, 4), np.array(there["quat"]).reshape(-1, 4)
    assert np.abs(np.abs((quats[0] * quats[1]).sum(axis=1)) - 1).max() < 1e-6


def test_a_slider_moves_bodies_as_mujoco_does(model: Path, open_page: Callable[..., Any]) -> None:
    with Session() as session:
        page = open_page(page_of("model.xml", model, session).as_uri())
        assert page.evaluate("mjcompose.world.pose.qpos[0]") == 0.1  # the first keyframe
        page.get_by_role("tab", name="Joints").click()
        before = page.evaluate(PLACES)["pos"]
        for name, value in (("slide", 0.22), ("first", -1.1), ("second", 2.0)):
            slider = page.locator(f"input[type=range][aria-label='{name}']")
            slider.evaluate(f"each => {{ each.value = {value}; each.dispatchEvent(new Event('input')); }}")
            _same(page, session)
        assert page.evaluate(PLACES)["pos"] != before
        page.locator("details", has_text="free").first.locator("summary").click()
        for name in ("yaw", "pitch", "x"):
            for slider in page.locator(f"input[type=range][aria-label='{name}']").all():
                slider.evaluate("each => { each.value = 0.7; each.dispatchEvent(new Event('input')); }")
                _same(page, session)
        generator = np.random.default_rng(1)
        for _ in range(5):
            page.evaluate("qpos => mjcompose.setQpos(qpos)", generator.normal(size=14).tolist())
            _same(page, session)


def test_the_number_beside_a_slider_has_its_unit(model: Path, open_page: Callable[..., Any]) -> None:
    with Session() as session:
        page = open_page(page_of("model.xml", model, session).as_uri())
    page.get_by_role("tab", name="Joints").click()
    number = page.get_by_label("first, value")
    number.fill("45")
    number.press("Enter")
    assert abs(page.evaluate("mjcompose.world.pose.qpos[1]") - np.pi / 4) < 1e-12
    assert number.input_value() == "45°"
    assert page.get_by_label("slide, value").input_value() == "0.1 m"


def test_a_pose_is_copied_as_a_keyframe_that_builds(model: Path, open_page: Callable[..., Any]) -> None:
    with Session() as session:
        page = open_page(page_of("model.xml", model, session).as_uri())
        page.evaluate("(() => { mjcompose.world.pose.qpos[1] = 0.5; mjcompose.sliders.ctrl[0] = 0.25; })()")
        snippet = page.evaluate("mjcompose.sliders.snippet()")
        assert "first: 28.647890deg".replace("890", "89") in snippet and "push: 0.25" in snippet
        (model / "recipe.yaml").write_text(f"recipe: 1\nbase: ./model.xml\n{snippet}")
        again = open_page(page_of("recipe.yaml", model, session, key="pose").as_uri())
        poses = [each.evaluate("Array.from(mjcompose.world.pose.qpos)") for each in (page, again)]
        assert np.abs(np.array(poses[0]) - poses[1]).max() < 1e-6
        assert again.evaluate("mjcompose.sliders.ctrl[0]") == 0.25


def test_it_makes_no_request_and_has_no_path_of_the_machine(
    model: Path, open_page: Callable[..., Any], browser: Any
) -> None:
    with Session() as session:
        path = page_of("model.xml", model, session)
        text = path.read_text(encoding="utf-8")
        assert path.read_bytes() == page_of("model.xml", model, session).read_bytes()
    assert str(model) not in text and str(Path(__file__).parents[3]) not in text
    assert not re.search(r"""(src|href)=["']?(https?:)?//""", text)
    asked: list[str] = []
    context = browser.new_context(offline=True)
    page = context.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-shown]", state="attached", timeout=60_000)
    for tab in ("Joints", "Controls", "Show", "Attach", "Info"):
        page.get_by_role("tab", name=tab).click()
    page.wait_for_timeout(300)
    context.close()
    assert [each for each in asked if not each.startswith(("blob:", "data:"))] == [path.as_uri()]


def test_the_tree_and_the_picture_select_each_other(model: Path, open_page: Callable[..., Any]) -> None:
    with Session() as session:
        page = open_page(page_of("model.xml", model, session).as_uri())
    page.evaluate("mjcompose.select({kind: 'geom', index: 0}, true)")
    assert page.locator(".row.selected").inner_text().split() == ["■", "box"]
    assert page.locator(".info .place").first.inner_text() == "model.xml:5"
    page.locator(".row.body", has_text="free").click()
    assert page.evaluate("mjcompose.selection") == {"kind": "body", "index": 4}
    page.evaluate("mjcompose.stage.fit(mjcompose.world.boxOf({kind: 'geom', index: 0}))")
    page.wait_for_timeout(200)
    box = page.locator("canvas").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert page.evaluate("mjcompose.selection") == {"kind": "geom", "index": 0}


def test_it_is_used_at_the_width_of_a_phone(model: Path, browser: Any) -> None:
    with Session() as session:
        path = page_of("model.xml", model, session)
    context = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True, color_scheme="dark")
    page = context.new_page()
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-shown]", state="attached", timeout=60_000)
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert page.locator("canvas").bounding_box()["width"] == 390
    page.get_by_label("joints and more").tap()
    page.get_by_role("tab", name="Joints").tap()
    page.wait_for_timeout(400)
    assert page.locator(".sliders input[type=range]").first.bounding_box()["y"] < 844
    context.close()


SOFT = """<mujoco>
  <worldbody>
    <body name="holder"><geom type="box" size="0.1 0.1 0.1"/>
      <flexcomp name="cloth" type="grid" count="3 3 1" spacing="0.1 0.1 0.1" dim="2" mass="0.1"><edge equality="true"/></flexcomp>
    </body>
  </worldbody>
</mujoco>
"""


def test_a_soft_body_is_in_the_tree_below_its_part_and_a_geom_without_a_name_is_called_by_its_type(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    (tmp_path / "cloth.xml").write_text(SOFT)
    (tmp_path / "recipe.yaml").write_text(
        "recipe: 1\nattach: {left: {model: ./cloth.xml}, right: {model: ./cloth.xml, pos: [1, 0, 0]}}\n"
    )
    with Session() as session:
        page = open_page(page_of("recipe.yaml", tmp_path, session).as_uri())
    assert page.locator(".row.part .name").all_inner_texts() == ["left/", "right/"]
    page.evaluate("mjcompose.select({kind: 'flex', index: 1}, true)")
    part = page.locator(".fold", has=page.locator("> .row.part", has_text="right/"))
    assert part.locator(".row.selected .name").inner_text() == "right/cloth"
    assert "box" in part.locator(".row.geom .name").all_inner_texts()
    assert "cloth.xml:4" in page.locator(".info").inner_text()
