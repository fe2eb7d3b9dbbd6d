"""The server, with a browser that looks on."""

from __future__ import annotations

import json
import stat
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from mjcompose.cli.reporting import words_of
from mjcompose.cli.view import faults_of
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.view import live
from mjcompose.tools.view.builder import Workshop
from mjcompose.tools.view.live import Service, serve, started
from mjcompose.tools.view.page import ViewChoice
from mjcompose.tools.view.server import PageServer

MODEL = (
    '<mujoco><worldbody><body name="arm"><joint name="elbow"/><geom name="{}" size="0.1"/></body></worldbody></mujoco>'
)
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
MESHED = """<mujoco><asset><mesh name="m" file="m.obj"/></asset>
<worldbody><geom type="mesh" mesh="m" rgba="{}"/></worldbody></mujoco>"""
FALL = "<mujoco><worldbody><body><joint type='slide'/><geom size='0.1'/></body></worldbody></mujoco>"
UNSTABLE = """<mujoco><option timestep="0.02"/><worldbody><body><joint type="slide"/><geom size="0.1"/><body>
<joint name="spring" type="slide" axis="0 0 1" stiffness="1e6" springref="0.5"/><geom size="0.05" mass="0.1"/></body></body></worldbody></mujoco>"""
RECIPE = """recipe: 1
base: ./arm.xml
variants: {size: {small: {}, large: {edit: [{select: {body: arm}, scale: {mass: 2}}]}}}
"""


@pytest.fixture
def server(tmp_path: Path) -> Iterator[PageServer]:
    (tmp_path / "arm.xml").write_text(MODEL.format("ball"))
    (tmp_path / "arm.yaml").write_text(RECIPE)
    with running("arm.yaml", tmp_path) as found:
        yield found


@contextmanager
def running(target: str, folder: Path, key: str | None = None, opens: bool = False) -> Iterator[PageServer]:
    """A server of a target, which watches."""
    with Session() as session:
        workshop = Workshop(
            target, ViewChoice(), session, lambda: Context(folder=folder), words_of, key, faults=faults_of
        )
        found = started(workshop, Service(), Context())
        assert found is not None
        stop = Event()
        thread = Thread(target=serve, args=(found, opens, lambda line: None, stop, lambda shown: None))
        thread.start()
        try:
            yield found
        finally:
            stop.set()
            thread.join()


def test_a_port_that_is_taken_is_a_line(server: PageServer) -> None:
    context = Context()
    port = int(server.address.split(":")[2].split("/")[0])
    assert started(server.workshop, Service(port=port), context) is None
    (fault,) = context.sink.errors
    assert fault.code == "no-server" and "already in use" in fault.message and "--port" in str(fault.help)


@pytest.mark.slow
def test_what_is_saved_is_shown_and_what_is_common_stays(
    server: PageServer, tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    page = open_page(server.address)
    other = open_page(server.address)
    page.evaluate("mjcompose.setQpos([0.7])")
    page.evaluate("mjcompose.select({kind: 'body', index: 1}, true)")
    page.evaluate("mjcompose.stage.camera.position.set(3, 2, 1)")
    (tmp_path / "arm.xml").write_text(MODEL.format("sphere"))
    for each in (page, other):
        each.wait_for_selector("html[data-shown='2']", state="attached", timeout=20_000)
        assert each.evaluate("mjcompose.world.model.scene.geom.name") == ["sphere"]
    assert page.evaluate(
        "[mjcompose.world.pose.qpos[0], mjcompose.selection.index, mjcompose.stage.camera.position.x]"
    ) == [0.7, 1, 3]


@pytest.mark.slow
def test_a_new_model_is_drawn_once_and_its_meshes_are_not_made_again(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    (tmp_path / "m.obj").write_text(TETRAHEDRON)
    (tmp_path / "meshed.xml").write_text(MESHED.format("1 0 0 1"))
    with running("meshed.xml", tmp_path) as server:
        page = open_page(server.address)
        page.wait_for_timeout(300)
        page.evaluate("window.before = mjcompose.world; before.surface = before.batches[0].mesh.geometry")
        frames = page.evaluate("mjcompose.stage.frames")
        (tmp_path / "meshed.xml").write_text(MESHED.format("0 1 0 1"))
        page.wait_for_selector("html[data-shown='2']", state="attached", timeout=20_000)
        page.wait_for_timeout(300)
        assert page.evaluate("mjcompose.world !== before")
        assert page.evaluate("mjcompose.world.batches[0].mesh.geometry === before.surface")
        assert page.evaluate("mjcompose.stage.frames") == frames + 1


@pytest.mark.slow
def test_a_fault_is_shown_above_the_last_good_model(
    server: PageServer, tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    page = open_page(server.address)
    (tmp_path / "arm.yaml").write_text("recipe: 1\nbase: ./arn.xml\n")
    page.wait_for_selector(".fault:not([hidden])", timeout=20_000)
    words = page.locator(".fault pre").inner_text()
    assert "arm.yaml:2:7: error[source-not-found]" in words and "^^^^" in words
    assert page.evaluate("mjcompose.world.model.scene.geom.name") == ["ball"]
    (tmp_path / "arm.yaml").write_text(RECIPE)
    page.wait_for_selector(".fault", state="hidden", timeout=20_000)
    (tmp_path / "arm.xml").unlink()
    page.wait_for_selector(".fault:not([hidden])", timeout=20_000)


@pytest.mark.slow
def test_the_first_build_may_fail_until_the_missing_file_is_there(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    (tmp_path / "models").mkdir()
    (tmp_path / "arm.yaml").write_text("recipe: 1\nbase: ./models/arm.xml\n")
    with running("arm.yaml", tmp_path) as server:
        page = open_page(server.address, models=None)
        page.wait_for_selector(".fault:not([hidden])", timeout=20_000)
        assert "arm.yaml:2:7: error[source-not-found]" in page.locator(".fault pre").inner_text()
        (tmp_path / "models" / "arm.xml").write_text(MODEL.format("ball"))
        page.wait_for_selector("html[data-shown='1']", state="attached", timeout=20_000)
        page.wait_for_selector(".fault", state="hidden")


@pytest.mark.slow
def test_a_page_that_lost_the_server_for_a_while_goes_on(
    server: PageServer, tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    page = open_page(server.address)
    server.hub.put(None)  # as after a sleep: no stream is left
    (tmp_path / "arm.xml").write_text(MODEL.format("sphere"))
    page.wait_for_selector("html[data-shown='2']", state="attached", timeout=20_000)


def test_a_keyframe_that_does_not_exist_is_a_fault(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(MODEL.format("ball"))
    with running("arm.xml", tmp_path, key="home") as server:
        assert server.workshop.build().fault is not None
        assert "keyframe `home`" in str(server.workshop.shown.fault) and server.workshop.shown.version == -1


@pytest.mark.slow
def test_a_menu_chooses_another_variant(server: PageServer, open_page: Callable[..., Any]) -> None:
    page = open_page(server.address)
    mass = "mjcompose.world.model.scene.body.mass[1]"
    before = page.evaluate(mass)
    page.get_by_label("variant size").select_option("large")
    page.wait_for_selector("html[data-shown='2']", state="attached", timeout=20_000)
    assert abs(page.evaluate(mass) / before - 2) < 1e-6
    assert json.loads(server.workshop.shown.text)["choices"][0]["value"] == "large"


@pytest.mark.slow
def test_physics_run_on_the_server(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    (tmp_path / "fall.xml").write_text(FALL)
    with running("fall.xml", tmp_path) as server:
        page = open_page(server.address)
        page.get_by_title("physics (space)").click()
        for _ in range(200):
            if page.evaluate("mjcompose.world.pose.qpos[0]") < -0.05:
                break
            page.wait_for_timeout(50)
        page.get_by_title("physics (space)").click()
        page.wait_for_selector(".tool.on", state="detached", timeout=20_000)
        fallen = page.evaluate("mjcompose.world.pose.qpos[0]")
        page.wait_for_timeout(200)
        assert page.evaluate("mjcompose.world.pose.qpos[0]") == fallen < -0.05


@pytest.mark.slow
def test_a_model_that_diverges_stops_with_a_sentence_and_can_be_mended(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    (tmp_path / "model.xml").write_text(UNSTABLE)
    with running("model.xml", tmp_path) as server:
        page = open_page(server.address)
        for _ in range(2):  # it may be tried again
            page.get_by_title("physics (space)").click()
            page.wait_for_selector(".fault:not([hidden])", timeout=20_000)
            words = page.locator(".fault").inner_text()
            assert (
                "The simulation has stopped" in words
                and "unstable: NaN or a huge acceleration in joint `spring`" in words
            )
            page.wait_for_selector(".tool.on", state="detached")
        (tmp_path / "model.xml").write_text(FALL)
        page.wait_for_selector("html[data-shown='2']", state="attached", timeout=20_000)
        page.wait_for_selector(".fault", state="hidden", timeout=20_000)


@pytest.mark.parametrize(("host", "says"), [("127.0.0.1", False), ("0.0.0.0", True)])
def test_a_page_that_others_can_reach_says_that_it_is_read_only(tmp_path: Path, host: str, says: bool) -> None:
    (tmp_path / "arm.xml").write_text(MODEL.format("ball"))
    lines: list[str] = []
    with Session() as session:
        workshop = Workshop("arm.xml", ViewChoice(), session, lambda: Context(folder=tmp_path), words_of)
        found = started(workshop, Service(host), Context())
        assert found is not None
        stop = Event()
        thread = Thread(target=serve, args=(found, False, lines.append, stop, lambda shown: None))
        thread.start()
        while not lines:
            time.sleep(0.02)
        stop.set()
        thread.join()
    assert any("read-only" in line for line in lines) == says
    assert workshop.writes is not says


def test_the_browser_gets_the_token_through_a_file_of_this_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Everybody on a machine can read command lines."""
    (tmp_path / "arm.xml").write_text(MODEL.format("ball"))
    opened: list[str] = []
    monkeypatch.setattr(live, "_no_browser", lambda: None)
    monkeypatch.setattr(live, "open_in_browser", opened.append)
    with running("arm.xml", tmp_path, opens=True) as server:
        for _ in range(200):
            if opened:
                break
            time.sleep(0.05)
        file = Path(unquote(urlsplit(opened[0]).path))
        assert server.guard.token not in opened[0] and opened[0].startswith("file:///")
        assert stat.S_IMODE(file.stat().st_mode) == 0o600
        assert f'content="0; url={server.address}"' in file.read_text()
    assert not file.exists() and len(opened) == 1


TOUCHING = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 0.5"><joint name="lift" type="slide" axis="0 0 1" range="-1 1"/><geom name="ball" size="0.1"/></body></worldbody>
<sensor><jointpos name="height" joint="lift"/></sensor><keyframe><key name="low" qpos="-0.42"/></keyframe></mujoco>"""


def seen(page: Any) -> Any:
    """The answer of the server about the pose that is shown."""
    end = time.monotonic() + 20
    while (found := page.evaluate("mjcompose.world.softs.seen")) is None and time.monotonic() < end:
        page.wait_for_timeout(50)
    return found


@pytest.mark.slow
def test_contacts_and_sensors_are_those_of_the_pose_that_is_shown(
    tmp_path: Path, open_page: Callable[..., Any]
) -> None:
    (tmp_path / "touching.xml").write_text(TOUCHING)
    with running("touching.xml", tmp_path) as server:
        page = open_page(server.address)
        page.get_by_role("tab", name="Joints").click()
        chips = page.locator("span.chip.on button:first-child")
        assert chips.all_inner_texts() == ["low"]
        slider = page.locator("input[type=range][aria-label='lift']")
        slider.evaluate("each => { each.value = 0.3; each.dispatchEvent(new Event('input')); }")
        assert chips.count() == 0, "no keyframe has this pose"
        assert page.locator("select[title=keyframe] option:checked").inner_text() == "low, moved"
        assert seen(page)["contacts"] == []
        slider.evaluate("each => { each.value = -0.45; each.dispatchEvent(new Event('input')); }")
        assert len(seen(page)["contacts"]) == 1 and seen(page)["sensors"] == [-0.45]
        page.get_by_role("button", name="low", exact=True).click()
        assert chips.all_inner_texts() == ["low"] and page.evaluate("mjcompose.world.softs.seen.sensors") == [-0.42]


@pytest.mark.slow
def test_a_page_without_its_server_says_so_until_it_is_back(server: PageServer, open_page: Callable[..., Any]) -> None:
    page = open_page(server.address)
    assert page.locator(".lost").is_hidden()
    page.route("**/events", lambda route: route.abort())
    server.hub.put(None)  # ends the connection of every page
    page.wait_for_selector(".lost:not([hidden])", timeout=20_000)
    assert "The server does not answer" in page.locator(".lost").inner_text()
    page.unroute("**/events")
    page.wait_for_selector(".lost", state="hidden", timeout=20_000)


@pytest.mark.slow
def test_a_recipe_that_is_used_twice_has_its_inner_parts_twice(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    for name in ("hand", "arm"):
        (tmp_path / f"{name}.xml").write_text(
            f'<mujoco><worldbody><body name="{name}"><geom size="0.1"/><site name="end"/></body></worldbody></mujoco>'
        )
    (tmp_path / "both.yaml").write_text("recipe: 1\nbase: ./arm.xml\nattach: {hand: {model: ./hand.xml, site: end}}\n")
    (tmp_path / "pair.yaml").write_text(
        "recipe: 1\nattach:\n  left: {model: ./both.yaml}\n  right: {model: ./both.yaml, pos: [1, 0, 0]}\n"
    )
    with running("pair.yaml", tmp_path) as server:
        page = open_page(server.address)
        below = (
            "each => each.parentElement.closest('.below')?.previousElementSibling?.querySelector('.name').textContent"
        )
        inner = page.locator(".left .row.part", has_text="hand/")
        assert [row.evaluate(f"row => ({below})(row.parentElement)") for row in inner.all()] == ["left/", "right/"]
        page.evaluate("mjcompose.select({kind: 'body', index: 4}, true)")
        bodies = page.locator(".left .row.selected").all_inner_texts()
        assert len(bodies) == 1 and "right/hand/hand" in bodies[0]


@pytest.mark.slow
@pytest.mark.parametrize("is_first", [False, True])
def test_a_fault_has_a_link_to_its_line_and_its_fix_is_a_click(
    tmp_path: Path, is_first: bool, open_page: Callable[..., Any]
) -> None:
    (tmp_path / "arm.xml").write_text(MODEL.format("ball"))
    good = "recipe: 1\nbase: ./arm.xml\nedit:\n  - {select: {body: arm}, scale: {mass: 2}}   # heavier\n"
    wrong = good.replace("body: arm", "body: arn")
    (tmp_path / "arm.yaml").write_text(wrong if is_first else good)
    with running("arm.yaml", tmp_path) as server:
        page = open_page(server.address, None if is_first else 1)
        if not is_first:
            (tmp_path / "arm.yaml").write_text(wrong)
        page.wait_for_selector(".fault:not([hidden])", timeout=20_000)
        link = page.locator(".fault a.place")
        assert link.inner_text() == "arm.yaml:4:14"
        assert link.get_attribute("href") == f"vscode://file{tmp_path}/arm.yaml:4:14"
        (tmp_path / "arm.yaml").write_text(wrong + "# more\n")
        page.wait_for_timeout(1000)
        page.get_by_role("button", name="Fix: write arm").click()
        page.wait_for_selector(".fault", state="hidden", timeout=20_000)
        assert (tmp_path / "arm.yaml").read_text() == good + "# more\n"
        page.evaluate("mjcompose.gizmo.idle")
        page.keyboard.press("Control+z")
        page.wait_for_selector(".fault:not([hidden])", timeout=20_000)
        assert (tmp_path / "arm.yaml").read_text() == wrong + "# more\n"
