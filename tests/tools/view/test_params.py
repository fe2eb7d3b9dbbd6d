"""The parameters of a recipe as sliders of a live page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tools.view.test_live import running
from tools.view.test_time import until

pytestmark = pytest.mark.slow
RECIPE = """recipe: 1
params:
  height: {default: 0.5, min: 0.1, max: 1.2, unit: m, doc: height of the shelf}   # in meters
  count: 2
  color: {default: oak, choices: [oak, steel]}
add:
  - {to: world, body: {name: shelf, pos: [0, 0, "${height}"], geom: {type: box, size: [0.1, 0.1, "${count * 0.01}"]}}}
"""
HEIGHT = "mjcompose.world.model.scene.body.pos[5]"


def test_a_slider_builds_while_it_is_dragged_and_write_changes_the_default(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    recipe = tmp_path / "shelf.yaml"
    recipe.write_text(RECIPE)
    with running("shelf.yaml", tmp_path) as server:
        page = open_page(server.address)
        page.get_by_role("tab", name="Params").click()
        sliders = page.locator(".sliders:visible input[type=range]")
        assert [each.get_attribute("aria-label") for each in sliders.all()] == ["height", "count"], "only numbers"
        height = page.locator("input[type=range][aria-label=height]")
        assert (height.get_attribute("min"), height.get_attribute("max")) == ("0.1", "1.2")
        handle = height.element_handle()
        for value in (0.6, 0.7, 0.8, 0.9):
            handle.evaluate("(each, value) => { each.value = value; each.dispatchEvent(new Event('input')); }", value)
        until(page, f"Math.abs({HEIGHT} - 0.9) < 1e-9")
        assert handle.evaluate("each => each.isConnected"), "a hand still holds it"
        assert recipe.read_text() == RECIPE
        box = page.get_by_label("parameter height, value")
        box.fill("7/10")
        page.keyboard.press("Enter")
        until(page, f"Math.abs({HEIGHT} - 0.7) < 1e-9")
        page.get_by_role("button", name="Write").first.click()
        until(page, "document.querySelector('.slider > .small').hidden")
        assert recipe.read_text() == RECIPE.replace("default: 0.5", "default: 0.7")
        box.fill("5")
        page.keyboard.press("Enter")
        page.wait_for_selector(".fault:not([hidden])", timeout=20_000)
        assert "1.2" in page.locator(".fault").inner_text(), "the bound of the parameter"
