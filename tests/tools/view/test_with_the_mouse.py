"""The tutorial for the mouse, carried out in a browser: after each step the recipe has the lines that the page shows."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tools.view.test_gizmo import AT, Mouse
from tools.view.test_live import running

PAGE = Path(__file__).resolve().parents[3] / "docs" / "tutorials" / "with_the_mouse.md"
SITE = """name => {
  const { scene } = mjcompose.world.model, { camera, canvas } = mjcompose.stage, box = canvas.getBoundingClientRect();
  const place = mjcompose.world.matrixOf("site", scene.site.name.indexOf(name));
  const point = camera.position.clone().setFromMatrixPosition(place).project(camera);
  return [box.left + (point.x + 1) * box.width / 2, box.top + (1 - point.y) * box.height / 2];
}"""


@pytest.mark.slow
def test_the_tutorial_for_the_mouse_is_true(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    text = PAGE.read_text(encoding="utf-8")
    first, last = re.findall(r'```yaml title="cell.yaml"\n(.*?)```', text, re.DOTALL)
    steps = iter(re.findall(r"```yaml\n(.*?)```", text, re.DOTALL))
    shutil.copytree(PAGE.parents[2] / "recipes", tmp_path / "recipes")
    (tmp_path / "cell.yaml").write_text(first)
    with running("cell.yaml", tmp_path) as server:
        page = open_page(server.address)
        hand = Mouse(page, tmp_path / "cell.yaml", server.workshop)

        def says(before: str) -> None:
            expected = next(steps)
            found = hand.changed(before)
            assert expected in found, found
            hand.rebuilt()

        def attach(site: str, name: str, model: str) -> str:
            before = hand.text
            search = page.get_by_label("search names")
            search.fill(site)
            page.locator(".left .row.site", has_text=site).first.click()
            search.fill("")
            page.get_by_role("button", name="Attach here…").first.click()
            page.get_by_label("name of the part").fill(name)
            page.get_by_label("model", exact=True).select_option(model)
            page.get_by_role("button", name="Attach", exact=True).click()
            return before

        says(attach("table/mount", "arm", "./recipes/models/arm6/arm6.xml"))
        before = attach("arm/attachment_site", "gripper", "./recipes/models/gripper2/gripper2.xml")
        before = hand.changed(before)
        hand.rebuilt()
        page.keyboard.press("m")
        hand.select("gripper/base")
        page.get_by_label("yaw, relative to its place").fill("90")
        page.keyboard.press("Enter")
        says(before)

        before = hand.changed(attach("table/corner", "watcher", "./recipes/models/camera_mount/camera_mount.xml"))
        hand.rebuilt()
        page.evaluate("document.activeElement.blur()")
        page.keyboard.press("Escape")
        page.keyboard.press("f")
        hand.select("watcher/base")
        hand.drag([[1, 0, 0]], "X", 0.55, lambda number: [30, 0])
        moved = hand.changed(before)
        assert re.search(r"site: table/corner, pos: \[-?0\.\d+, 0, 0\]", moved), moved
        hand.rebuilt()
        page.get_by_label("x, relative to its place").fill("-0.1")
        page.keyboard.press("Enter")
        says(moved)

        before = hand.text
        hand.select("arm/base")
        x, y = page.evaluate(AT, [[0, 0, 0], 0])
        there = page.evaluate(SITE, "table/corner")
        hand.drag([[0, 0, 0]], "XYZ", 0, lambda number: [there[0] - x, there[1] - y])
        says(before)
        moved = hand.text
        page.keyboard.press("Control+z")
        says(moved)
        assert hand.text == before

        page.get_by_role("tab", name="Joints").click()
        page.get_by_label("arm/shoulder_lift, value").first.fill("30")
        page.keyboard.press("Enter")
        page.get_by_role("button", name="Save this pose in the recipe").click()
        page.get_by_label("name of the keyframe").fill("reach")
        page.get_by_role("button", name="Save", exact=True).click()
        says(before)
        assert hand.text == last and next(steps, None) is None
