"""Ghosts, distances, axes and detail of a page, in a real browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of

pytestmark = pytest.mark.slow
MODEL = """<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 1"/>
    <body name="arm" pos="0 0 0.5"><joint name="swing" axis="0 1 0"/><geom name="rod" type="box" size="0.5 0.05 0.05"/></body>
  </worldbody>
  <keyframe><key name="down" qpos="1.2"/></keyframe>
</mujoco>
"""
AT = (
    "([x, y, z]) => { mjcompose.stage.sharp(); const at = mjcompose.stage.camera.position.clone().set(x, y, z).project(mjcompose.stage.camera),"
    " box = mjcompose.canvas.getBoundingClientRect();"
    " return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height]; }"
)


@pytest.fixture
def page(tmp_path: Path, open_page: Callable[..., Any]) -> Any:
    (tmp_path / "model.xml").write_text(MODEL)
    with Session() as session:
        return open_page(page_of("model.xml", tmp_path, session).as_uri())


def test_the_axes_look_along_one_by_mouse_and_by_keys(page: Any) -> None:
    page.get_by_role("button", name="look from +X").click()
    way = "(() => { const { camera, controls } = mjcompose.stage; return camera.position.clone().sub(controls.target).normalize().toArray(); })()"
    assert page.evaluate(way) == pytest.approx([1, 0, 0], abs=1e-3)
    page.get_by_role("button", name="look from −Y").focus()
    page.keyboard.press("Enter")
    assert page.evaluate(way) == pytest.approx([0, -1, 0], abs=1e-3)


def test_a_distance_is_between_two_points_on_their_bodies(page: Any) -> None:
    page.keyboard.press("r")
    page.get_by_role("button", name="look from −Y").click()
    page.keyboard.press("d")
    for point in ([-0.4, -0.05, 0.5], [0.4, -0.05, 0.5]):
        page.mouse.click(*page.evaluate(AT, point))
    page.wait_for_selector(".measure:not([hidden])")
    shown = page.locator(".measure b").inner_text()
    assert float(shown.removesuffix(" m")) == pytest.approx(0.8, abs=0.01)
    page.keyboard.press("Escape")
    page.wait_for_selector(".measure", state="hidden")  # with the next frame


def test_a_ghost_is_the_model_at_a_keyframe(page: Any) -> None:
    page.get_by_role("tab", name="Joints").click()
    page.get_by_role("button", name="reference", exact=True).click()
    before = page.evaluate("mjcompose.world.pose.qpos[0]")
    page.get_by_role("button", name="show a ghost at down").click()
    assert page.get_by_role("button", name="show a ghost at down").get_attribute("aria-pressed") == "true"
    count, matrix = page.evaluate(
        "(() => { const [group] = mjcompose.poses.ghosts.root.children, matrix = mjcompose.world.bodyMatrix(0).clone();"
        " group.children[0].getMatrixAt(0, matrix); return [group.children.length, matrix.elements.slice(0, 3)]; })()"
    )
    assert count == 1, "only what moves"
    assert matrix == pytest.approx([0.5 * 0.3624, 0, -0.5 * 0.932], abs=1e-3)
    assert page.evaluate("mjcompose.world.pose.qpos[0]") == before == 0
    page.get_by_role("button", name="show a ghost at down").click()
    assert page.evaluate("mjcompose.poses.ghosts.root.children.length") == 0


def test_a_click_into_the_empty_keeps_the_tab(page: Any) -> None:
    page.get_by_role("tab", name="Joints").click()
    left, top = page.evaluate(
        "(() => { const box = mjcompose.canvas.getBoundingClientRect(); return [box.left, box.top]; })()"
    )
    page.mouse.click(left + 5, top + 5)
    assert page.get_by_role("tab", name="Joints").get_attribute("aria-selected") == "true"
    page.keyboard.press("Escape")
    page.get_by_role("tab", name="Joints").focus()
    page.keyboard.press("ArrowRight")
    assert page.get_by_role("tab", name="Controls").get_attribute("aria-selected") == "true"


def test_a_picture_has_the_size_of_the_canvas(page: Any) -> None:
    page.evaluate(
        "(() => { navigator.clipboard.write = async ([item]) => { window.copied = await item.getType('image/png'); }; })()"
    )
    page.keyboard.press("p")
    page.wait_for_selector(".toast")
    size = page.evaluate("createImageBitmap(copied).then((image) => [image.width, image.height])")
    assert size == page.evaluate("[mjcompose.canvas.width, mjcompose.canvas.height]")


KINDS = ("box", "sphere", "capsule", "cylinder", "ellipsoid")
MOST_TRIANGLES = 20_000


def test_three_hundred_geoms_are_few_triangles_while_the_camera_moves(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    bodies = "".join(
        f'<body pos="{k % 20 * 0.25} {k // 20 * 0.25} 0.1"><freejoint/><geom type="{KINDS[k % 5]}" size=".05 .06 .04"/></body>'
        for k in range(300)
    )
    (tmp_path / "many.xml").write_text(
        f"<mujoco><worldbody><light directional='true' castshadow='true'/>{bodies}</worldbody></mujoco>"
    )
    with Session() as session:
        page = open_page(page_of("many.xml", tmp_path, session).as_uri())
    drawn = "(ease) => { const { stage } = mjcompose; stage.ease = ease; stage.isMoving = ease < 1; stage.now(); return stage.renderer.info.render; }"
    still = page.evaluate(drawn, 1)
    moving = page.evaluate(drawn, 0)
    assert moving["triangles"] < MOST_TRIANGLES < still["triangles"], "and no shadows, which stay as they were"
    assert moving["calls"] < 20


def test_escape_closes_only_what_is_on_top(page: Any) -> None:
    page.evaluate("mjcompose.select({kind: 'body', index: 1}, false)")
    page.evaluate("mjcompose.setFault('model.xml:1:1: error[x]: y')")
    page.keyboard.press("?")
    assert page.locator("dialog.help").is_visible()
    columns = page.evaluate(
        "[...document.querySelectorAll('dialog dt, dialog dd')].map(each => [each.firstChild.getBoundingClientRect?.().right ?? 0,"
        " each.getBoundingClientRect().left])"
    )
    assert all(columns[k][0] <= columns[k + 1][1] for k in range(0, len(columns), 2)), "no key runs into its words"
    page.keyboard.press("Escape")
    page.wait_for_selector("dialog", state="detached")
    assert page.locator(".fault").is_visible() and page.evaluate("mjcompose.selection.index") == 1
    page.keyboard.press("Escape")
    assert page.locator(".fault").is_hidden() and page.evaluate("mjcompose.selection.index") == 1
    page.keyboard.press("Escape")
    assert page.evaluate("mjcompose.selection") is None


def test_a_long_name_loses_its_middle(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    names = [f"a_very_long_prefix_of_a_robot/with_an_arm/finger_{side}" for side in ("left", "right")]
    bodies = "".join(f'<body name="{name}"><geom size="0.1"/></body>' for name in names)
    (tmp_path / "model.xml").write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    with Session() as session:
        shown = open_page(page_of("model.xml", tmp_path, session).as_uri())
    tree = shown.locator(".left").bounding_box()
    for name in names:
        tail = shown.locator(f".left .row[title='body {name}'] .tail").bounding_box()
        assert tail["width"] > 40 and tail["x"] + tail["width"] <= tree["x"] + tree["width"]


def test_a_browser_without_webgl_says_what_to_do(browser: Any, tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    with Session() as session:
        address = page_of("model.xml", tmp_path, session).as_uri()
    context = browser.new_context()
    context.add_init_script(
        "const get = HTMLCanvasElement.prototype.getContext;"
        "HTMLCanvasElement.prototype.getContext = function (kind, ...more) {"
        " return kind === 'webgl2' ? null : get.call(this, kind, ...more); };"
    )
    shown = context.new_page()
    shown.goto(address)
    shown.wait_for_selector(".broken")
    assert "no WebGL 2. Turn on hardware acceleration" in shown.locator(".broken").inner_text()
    context.close()
