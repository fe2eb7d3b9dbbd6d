"""A page that plays the model by itself, with MuJoCo's WebAssembly."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of
from tools.view.test_live import UNSTABLE

pytestmark = pytest.mark.slow
TENT = "v 0 0 0.2\nv 0.2 0 0\nv -0.1 0.1 0\nv -0.1 -0.1 0\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n"
MODEL = """<mujoco>
  <asset><mesh file="tent.obj"/></asset>
  <worldbody>
    <body name="arm" pos="0 0 1"><joint name="swing" axis="0 1 0" damping="0.1"/><geom type="mesh" mesh="tent" pos="0.3 0 0"/></body>
  </worldbody>
  <actuator><motor name="push" joint="swing" ctrlrange="-1 1"/></actuator>
</mujoco>
"""
PLAYED = "() => [mjcompose.server.data.time, mjcompose.server.data.qpos[0], mjcompose.world.pose.qpos[0]]"


def swung(mujoco: Any, model: Any, asked: list[float]) -> float:
    """Where the arm is at a time. Runs in the child."""
    data = mujoco.MjData(model)
    data.qpos[0], data.ctrl[0] = asked[1:]
    while data.time < asked[0] - 1e-9:
        mujoco.mj_step(model, data)
    return float(data.qpos[0])


swung.__module__ = "tools.view.test_played"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    (tmp_path / "tent.obj").write_text(TENT)
    (tmp_path / "model.xml").write_text(MODEL)
    return tmp_path


def test_it_moves_as_in_mujoco(model: Path, open_page: Callable[..., Any]) -> None:
    with Session() as session:
        page = open_page(page_of("model.xml", model, session, physics=True).as_uri())
        page.evaluate("(() => { mjcompose.world.pose.qpos[0] = 0.5; mjcompose.sliders.ctrl[0] = 0.25; })()")
        page.keyboard.press("Space")
        page.wait_for_function("mjcompose.server.data?.time > 0.2", timeout=60_000)
        page.keyboard.press("Space")
        page.wait_for_selector(".tool.on", state="detached")
        time, there, shown = page.evaluate(PLAYED)
        assert there == shown and abs(there - 0.5) > 0.01
        answer = engine.call(session, swung, ["page"], [time, 0.5, 0.25])
        assert answer.ok and abs(answer.value - there) < 1e-6


def test_a_moved_slider_moves_what_is_played(model: Path, open_page: Callable[..., Any]) -> None:
    with Session() as session:
        page = open_page(page_of("model.xml", model, session, physics=True).as_uri())
    page.keyboard.press("Space")
    page.wait_for_function("mjcompose.server.data?.time > 0", timeout=60_000)
    page.get_by_role("tab", name="Joints").click()
    slider = page.locator("input[type=range][aria-label='swing']")
    moved = slider.evaluate(
        "each => { each.value = 2; each.dispatchEvent(new Event('input')); return mjcompose.server.data.qpos[0]; }"
    )
    assert moved == 2


def test_its_bytes_are_the_same_and_say_nothing_of_the_machine(model: Path) -> None:
    from tools.view.pages import unpacked

    with Session() as session:
        first = page_of("model.xml", model, session, physics=True).read_bytes()
        assert page_of("model.xml", model, session, physics=True).read_bytes() == first
        plain = page_of("model.xml", model, session).read_text("utf-8")
    text = first.decode()
    assert all(str(model) not in each and "manifest" not in each for each in (text, *unpacked(text)))
    assert "unsafe-eval" in text and "unsafe-eval" not in plain.split("<script")[0]
    assert len(plain) < 1_000_000 < len(first) < 5_000_000


def test_a_model_that_diverges_stops_with_a_sentence(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "model.xml").write_text(UNSTABLE)
    with Session() as session:
        page = open_page(page_of("model.xml", tmp_path, session, physics=True).as_uri())
    for _ in range(2):  # it may be tried again
        page.keyboard.press("Space")
        page.wait_for_selector(".fault:not([hidden])", timeout=60_000)
        words = page.locator(".fault").inner_text()
        assert "unstable: NaN or a huge acceleration in joint `spring`" in words
        page.wait_for_selector(".tool.on", state="detached")
        page.keyboard.press("Escape")


RESTING = """<mujoco>
  <visual><map stiffness="1000"/></visual>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="box" pos="0 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="2"/><site name="s"/></body>
  </worldbody>
  <sensor><framepos name="place" objtype="body" objname="box"/></sensor>
</mujoco>
"""


def test_sensors_contacts_and_the_clock_are_those_of_the_physics(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "model.xml").write_text(RESTING)
    with Session() as session:
        page = open_page(page_of("model.xml", tmp_path, session, physics=True).as_uri())
    page.get_by_role("tab", name="Sensors").click()
    page.get_by_label("place z").check()
    page.keyboard.press("Space")
    page.wait_for_function("mjcompose.server.data?.time > 0.3", timeout=60_000)
    page.keyboard.press("Space")
    page.wait_for_selector(".tool.on", state="detached")
    time, height, up = page.evaluate(
        "[mjcompose.server.data.time, mjcompose.server.data.qpos[2],"
        " mjcompose.world.softs.seen.contacts.reduce((sum, each) => sum + each[10], 0)]"
    )
    assert abs(up - 2 * 9.81) < 0.2
    head, *rows = page.evaluate("mjcompose.meters.plot.table()").splitlines()
    assert head == "time,place z" and len(rows) > 3
    assert [float(each) for each in rows[-1].split(",")] == pytest.approx([time, height], abs=1e-6)
    shown = page.locator(".meters label", has_text="place z").locator(".value").inner_text()
    assert float(shown.removesuffix(" m")) == pytest.approx(height, abs=1e-4)
    assert page.locator(".clock").inner_text() == f"{time:.2f} s · paused"


def test_ctrl_and_the_mouse_pull_a_body(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "model.xml").write_text(RESTING)
    with Session() as session:
        page = open_page(page_of("model.xml", tmp_path, session, physics=True).as_uri())
    page.evaluate("mjcompose.stage.lookFrom(mjcompose.stage.camera.position.clone().set(0, -1, 0.3).normalize())")
    page.keyboard.press("Space")
    page.wait_for_function("mjcompose.server.data?.time > 0", timeout=60_000)
    x, y = page.evaluate(
        "(() => { mjcompose.stage.sharp(); const at = mjcompose.stage.camera.position.clone().set(0, 0, 0.1).project(mjcompose.stage.camera),"
        " box = mjcompose.canvas.getBoundingClientRect();"
        " return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height]; })()"
    )
    view = page.evaluate("mjcompose.stage.camera.position.toArray()")
    page.keyboard.down("Control")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - 240)
    assert page.evaluate("mjcompose.puller.arrow.visible || mjcompose.puller.isPulling")
    page.wait_for_function("mjcompose.world.pose.pos[5] > 0.15", timeout=60_000)
    page.mouse.up()
    page.keyboard.up("Control")
    assert page.evaluate("mjcompose.stage.camera.position.toArray()") == view, "the camera stays"
    page.wait_for_function("!mjcompose.puller.isPulling && !mjcompose.server.data.xfrc_applied.some(Boolean)")
