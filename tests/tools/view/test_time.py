"""The time of the physics on a page: steps, speeds, reset, the last seconds again, and two tabs of one simulation."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.mujoco.engine import Session
from mjcompose.tools.view.simulation import Past
from tools.view.pages import page_of
from tools.view.test_live import running

FALL = """<mujoco><worldbody><body><joint name="fall" type="slide" axis="0 0 1"/><geom size="0.1"/></body></worldbody>
<actuator><motor name="push" joint="fall"/></actuator>
<keyframe><key name="high" qpos="5" ctrl="0.5"/><key name="low" qpos="-5"/></keyframe></mujoco>"""
HEIGHT = "mjcompose.world.pose.qpos[0]"
TIME = "Number(document.querySelector('.clock').textContent.split(' ')[0])"


def until(page: Any, condition: str) -> None:
    """Wait, in a page whose policy lets nobody evaluate text."""
    for _ in range(400):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(50)
    raise AssertionError(condition)


def test_states_are_kept_for_seconds_and_up_to_a_size() -> None:
    past = Past(seconds=1.0)
    for number in range(31):
        past.add({"time": number / 10, "qpos": [float(number)]})
    assert past.range == [2.0, 3.0]
    assert past.at(2.55) == {"time": 2.5, "qpos": [25.0]} and past.at(-1) == {"time": 2.0, "qpos": [20.0]}
    past.add({"time": 2.3, "qpos": [0.0]})
    assert past.range == [2.0, 2.3], "it went on from an earlier state"
    small = Past(size=200)
    for number in range(100):
        small.add({"time": number / 1000, "qpos": [number / 7]})
    first, last = small.range or [0, 0]
    assert last == 0.099 and 0.08 < first < last
    small.clear()
    assert small.range is None and small.at(0) is None


def played(page: Any) -> None:
    """What the bar of time does, on any page with physics."""
    page.keyboard.press(".")
    until(page, f"{HEIGHT} < 5")
    assert page.evaluate(HEIGHT) == pytest.approx(5 - 0.002**2 * (9.81 - 0.5 / 4.18879), abs=1e-7), "one step"
    page.keyboard.press(".")
    until(page, f"{HEIGHT} < 5 - 2.5 * 0.002 ** 2 * 9.6")
    page.keyboard.press("Space")
    until(page, f"{HEIGHT} < 4.5")
    page.keyboard.press("Space")
    page.wait_for_selector(".tool.on", state="detached")
    page.wait_for_timeout(200)
    there = page.evaluate(HEIGHT)
    speed = page.evaluate(TIME)
    slider = page.get_by_label("the last seconds")
    first = slider.evaluate("each => { each.value = each.min; each.dispatchEvent(new Event('input')); }")
    assert first is None
    until(page, f"{HEIGHT} > 4.99")
    assert page.evaluate(TIME) < 0.1
    slider.evaluate("each => { each.value = each.max; each.dispatchEvent(new Event('input')); }")
    until(page, f"{HEIGHT} === {there}")
    page.keyboard.press("Space")
    until(page, f"{TIME} > {speed} + 0.2")
    page.keyboard.press("Space")
    page.wait_for_selector(".tool.on", state="detached")
    fallen = 5 - page.evaluate(HEIGHT)
    free = 0.5 * (9.81 - 0.5 / 4.18879) * page.evaluate(TIME) ** 2
    assert fallen == pytest.approx(free, rel=0.05), "it went on with its speed"
    page.keyboard.press("Backspace")
    until(page, f"{HEIGHT} === 5")
    assert page.locator(".clock").is_hidden() and slider.is_hidden()


@pytest.mark.slow
def test_a_page_of_a_server_steps_goes_back_and_resets(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "fall.xml").write_text(FALL)
    with running("fall.xml", tmp_path) as server:
        played(open_page(server.address))


@pytest.mark.slow
def test_a_page_that_plays_by_itself_steps_goes_back_and_resets(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "fall.xml").write_text(FALL)
    with Session() as session:
        played(open_page(page_of("fall.xml", tmp_path, session, physics=True).as_uri()))


@pytest.mark.slow
def test_a_second_tab_shows_the_same_and_disturbs_nothing(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "fall.xml").write_text(FALL)
    with running("fall.xml", tmp_path) as server:
        page = open_page(server.address)
        page.get_by_role("tab", name="Controls").click()
        page.get_by_label("push, value").fill("0.25")
        page.keyboard.press("Enter")
        page.keyboard.press("Space")
        until(page, f"{HEIGHT} < 4.9")
        other = open_page(server.address)
        until(other, f"{HEIGHT} < 4.8")
        assert page.evaluate("mjcompose.sliders.ctrl[0]") == 0.25, "opening a tab sets no controls"
        assert other.evaluate("mjcompose.sliders.ctrl[0]") == 0.25, "and it shows those that act"
        other.get_by_label("speed").select_option("0.25")
        until(page, "document.querySelector('.time select').value === '0.25'")
        other.get_by_label("keyframe", exact=True).select_option("low")
        until(page, f"{HEIGHT} < -4.9 && {HEIGHT} > -6")
        assert page.evaluate("mjcompose.time.isPlaying"), "the keyframe is where it goes on"
        page.keyboard.press("r")
        until(other, f"{HEIGHT} > -1 && {HEIGHT} < 0")
        page.keyboard.press("Space")
        until(other, "!mjcompose.time.isPlaying")
        third = open_page(server.address)
        until(third, f"{HEIGHT} === {page.evaluate(HEIGHT)}")
        assert third.locator(".clock").inner_text() == page.locator(".clock").inner_text()


@pytest.mark.slow
@pytest.mark.parametrize("alone", [False, True])
def test_it_pauses_at_the_first_warning_of_each_kind(
    tmp_path: Path, alone: bool, open_page: Callable[..., Any]
) -> None:
    (tmp_path / "fall.xml").write_text(FALL)
    with running("fall.xml", tmp_path) as server, Session() as session:
        address = page_of("fall.xml", tmp_path, session, physics=True).as_uri() if alone else server.address
        page = open_page(address)
        page.get_by_role("tab", name="Controls").click()
        page.get_by_label("push, value").fill("1e11")
        page.keyboard.press("Enter")
        page.keyboard.press("Space")
        page.wait_for_selector(".fault.stopped:not([hidden])", timeout=60_000)
        words = page.locator(".fault").inner_text()
        assert "Paused at a warning of MuJoCo" in words and "ctrl" in words.lower(), words
        assert not page.evaluate("mjcompose.time.isPlaying")
        page.keyboard.press("Space")
        until(page, "mjcompose.time.isPlaying")
        page.wait_for_timeout(500)
        assert page.evaluate("mjcompose.time.isPlaying"), "it has said this already"
