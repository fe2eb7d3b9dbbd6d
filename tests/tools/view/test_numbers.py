"""The number boxes of the page: what they take, and what they leave alone."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of
from tools.view.test_gizmo import MODELS, Mouse
from tools.view.test_live import running

pytestmark = pytest.mark.slow
MODEL = """<mujoco><worldbody><body name="arm">
<joint name="turn" axis="0 0 1"/><joint name="lift" type="slide" axis="0 0 1"/><geom size="0.1"/></body></worldbody>
<actuator><motor name="push" joint="lift"/></actuator></mujoco>"""
TAKEN = {
    "turn": {
        "30": math.radians(30),
        "30deg": math.radians(30),
        "90/4": math.radians(22.5),
        "-45°": math.radians(-45),
        "−45°": math.radians(-45),
        "0.5rad": 0.5,
        "2 * (10deg + 0.1 rad)": 2 * math.radians(10) + 0.2,
    },
    "lift": {
        "0.1": 0.1,
        "10cm": 0.1,
        "250 mm": 0.25,
        "2in": 0.0508,
        "1/4": 0.25,
        "1e-1": 0.1,
        "-(0.1 + 0.2)/3": -0.1,
        "10cm + 5mm": 0.105,
        "0.3 m": 0.3,
    },
    "push": {"1e3": 1000, "3/4": 0.75},
}
REFUSED = {
    "turn": ["10cm", "abc", "", "1,5", "10deg + 1", "1rad/1rad"],
    "lift": ["0.5rad", "10km", "1 2", "1/0", "1//2", "(1", "10cm + 1", "1cm*1cm", "0x10", "1e999", "constructor"],
    "push": ["10cm", "5 N"],
}


def test_a_box_takes_units_and_sums_and_refuses_anything_else(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "model.xml").write_text(MODEL)
    with Session() as session:
        page = open_page(page_of("model.xml", tmp_path, session).as_uri())
    value = {
        "turn": "mjcompose.world.pose.qpos[0]",
        "lift": "mjcompose.world.pose.qpos[1]",
        "push": "mjcompose.sliders.ctrl[0]",
    }
    for name, texts in TAKEN.items():
        page.get_by_role("tab", name="Controls" if name == "push" else "Joints").click()
        box = page.get_by_label(f"{name}, value")
        for text, expected in texts.items():
            box.fill(text)
            box.press("Enter")
            assert page.evaluate(value[name]) == pytest.approx(expected, abs=1e-12), text
        before = page.evaluate(value[name])
        for text in REFUSED[name]:
            box.fill(text)
            box.press("Enter")
            assert box.get_attribute("aria-invalid") == "true" and box.input_value() == text, text
            assert page.evaluate(value[name]) == before, text
        box.press("Escape")
        assert box.get_attribute("aria-invalid") == "false" and box.input_value() != REFUSED[name][-1]


def test_a_place_in_centimeters_is_written_in_meters_and_nonsense_is_not_written(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    shutil.copytree(MODELS, tmp_path / "models")
    (tmp_path / "cell.yaml").write_text(
        "recipe: 1\nangle: degree\nattach:\n  table: {model: ./models/table/table.xml, pos: [0, 0, 0], euler: [0, 0, 0]}\n"
    )
    with running("cell.yaml", tmp_path) as server:
        page = open_page(server.address)
        hand = Mouse(page, tmp_path / "cell.yaml", server.workshop)
        page.keyboard.press("m")
        hand.select("table/table")
        first = hand.text
        for text in ("10kg", "0.5rad", "1,5"):
            page.get_by_label("x, relative to its place").fill(text)
            page.keyboard.press("Enter")
            assert page.get_by_label("x, relative to its place").get_attribute("aria-invalid") == "true"
        assert hand.text == first
        page.get_by_label("x, relative to its place").fill("10cm")
        page.keyboard.press("Enter")
        assert "pos: [0.1, 0, 0]" in hand.changed(first)
        hand.rebuilt()
        second = hand.text
        page.get_by_label("yaw, relative to its place").fill("0.5rad")
        page.keyboard.press("Enter")
        assert "euler: [0, 0, 28.648]" in hand.changed(second)
        hand.rebuilt()
        third = hand.text
        page.get_by_label("y, relative to its place").fill("20000")
        page.keyboard.press("Enter")
        page.locator(".toast", has_text="10000").wait_for()
        assert hand.text == third, "and the page says why"
