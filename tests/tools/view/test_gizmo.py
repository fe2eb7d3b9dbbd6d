"""A page that writes the recipe, in a browser: what the mouse does, and what the recipe says afterwards."""

from __future__ import annotations

import json
import math
import shutil
import time
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from mjcompose.tools.view.builder import Workshop
from tools.view.test_live import running

MODELS = Path(__file__).parents[3] / "recipes" / "models"
RECIPE = """recipe: 1
angle: degree
base: ./models/scenes/floor.xml
attach:
  table: {model: ./models/table/table.xml}
  arm: {model: ./models/arm6/arm6.xml, site: table/mount}   # six axes
  gripper:
    model: ./models/gripper2/gripper2.xml
    site: arm/attachment_site
    pos: [0, 0, 0.01]   # the flange
    euler: [0, 0, 45]
  cube: {model: ./models/props/cube.xml, pos: [0.15, 0, 0.75]}
"""
# A point of the picture on a handle, some pixels from the origin along an axis in the frame of the handle.
AT = """([axis, far]) => {
  const { gizmo, stage } = mjcompose, { camera, canvas } = stage, box = canvas.getBoundingClientRect();
  gizmo.handle.updateMatrixWorld(true);
  const V = stage.camera.position.constructor, origin = new V().setFromMatrixPosition(gizmo.handle.matrixWorld);
  const size = origin.distanceTo(camera.position) * Math.min(1.9 * Math.tan(Math.PI * camera.fov / 360), 7) / 4;
  const point = new V(...axis).multiplyScalar(size * far).applyMatrix4(gizmo.handle.matrixWorld).project(camera);
  return [box.left + (point.x + 1) * box.width / 2, box.top + (1 - point.y) * box.height / 2];
}"""


class Mouse:
    """A page whose recipe is in a folder, and the hand of who uses it."""

    def __init__(self, page: Any, recipe: Path, workshop: Workshop) -> None:
        self.page = page
        self.recipe = recipe
        self.workshop = workshop

    @property
    def text(self) -> str:
        return self.recipe.read_text()

    def until(self, condition: str) -> None:
        """Wait until something is so in the page, whose policy lets nobody else evaluate text."""
        end = time.monotonic() + 30
        while not self.page.evaluate(condition):
            assert time.monotonic() < end, condition
            self.page.wait_for_timeout(20)

    def select(self, body: str) -> None:
        self.page.evaluate(
            "name => mjcompose.select({kind: 'body', index: mjcompose.world.model.scene.body.name.indexOf(name)}, true)",
            body,
        )
        self.until("mjcompose.gizmo.controls.object !== undefined")
        self.page.wait_for_timeout(100)

    def hovers(self, point: list[float], far: float, axis: str) -> list[float] | None:
        """Put the mouse on a handle, and return where that is; None if another handle is there."""
        x, y = self.page.evaluate(AT, [point, far])
        self.page.mouse.move(x - 1, y)
        self.page.mouse.move(x, y)
        self.page.wait_for_timeout(50)
        return [x, y] if self.page.evaluate("mjcompose.gizmo.controls.axis") == axis else None

    def drag(self, points: list[list[float]], axis: str, far: float, to: Callable[[int], list[float]]) -> None:
        """Drag a handle, at the first of some points where it is, by some pixels."""
        end = time.monotonic() + 30
        number = 0
        while (at := self.hovers(points[number % len(points)], far, axis)) is None:
            assert time.monotonic() < end, "a handle is drawn a moment after it is attached"
            number += 1
        dx, dy = to(number % len(points))
        self.page.mouse.down()
        for part in range(1, 6):
            self.page.mouse.move(at[0] + dx * part / 5, at[1] + dy * part / 5)
        self.page.mouse.up()

    def turn(self) -> None:
        """Drag the ring about z."""
        ring = [[math.cos(each * math.pi / 6), math.sin(each * math.pi / 6), 0.0] for each in range(12)]

        def along(number: int) -> list[float]:
            (ax, ay), (bx, by) = (self.page.evaluate(AT, [ring[each % 12], 0.5]) for each in (number, number + 1))
            return [bx - ax, by - ay]

        self.drag(ring, "Z", 0.5, along)

    def changed(self, before: str) -> str:
        """The text of the recipe once it is another one."""
        end = time.monotonic() + 20
        while (text := self.text) == before:
            assert time.monotonic() < end, self.page.locator(".gizmo").inner_text()
            time.sleep(0.02)
        return text

    def pose(self, body: str) -> list[float]:
        return list(
            self.page.evaluate(
                "name => { const { scene, pose: { pos, quat } } = Object.assign({scene: mjcompose.world.model.scene}, {pose: mjcompose.world.pose}), b = scene.body.name.indexOf(name); return [...pos.slice(3 * b, 3 * b + 3), ...quat.slice(4 * b, 4 * b + 4)]; }",
                body,
            )
        )

    def rebuilt(self) -> None:
        """Wait until the model on the page is that of the recipe."""
        end = time.monotonic() + 30
        while self.workshop.shown.targets.texts.get("cell.yaml") != self.recipe.read_bytes():
            assert time.monotonic() < end
            time.sleep(0.02)
        self.until(f"mjcompose.world.model.scene.move.version === {self.workshop.shown.version}")
        self.page.wait_for_timeout(100)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(MODELS, tmp_path / "models")
    (tmp_path / "cell.yaml").write_text(RECIPE)
    return tmp_path


@pytest.mark.slow
def test_a_gripper_is_dragged_turned_and_put_back_and_a_pose_is_saved(
    folder: Path, open_page: Callable[..., Any]
) -> None:
    with running("cell.yaml", folder) as server:
        page = open_page(server.address)
        hand = Mouse(page, folder / "cell.yaml", server.workshop)
        page.keyboard.press("m")
        hand.select("gripper/base")
        assert page.get_by_label("z, relative to its place").input_value() == "0.01 m"
        start = hand.pose("gripper/base")

        hand.drag([[0, 0, 1]], "Z", 0.55, lambda number: [0, -60])
        moved = hand.pose("gripper/base")  # at once, before anything is built
        text = hand.changed(RECIPE)
        line = next(each for each in text.splitlines() if "pos:" in each and "flange" in each)
        x, y, z = (float(each) for each in line[line.index("[") + 1 : line.index("]")].split(","))
        assert line.endswith("]   # the flange") and z != 0.01 and abs(z / 0.005 - round(z / 0.005)) < 1e-6
        assert text == RECIPE.replace("[0, 0, 0.01]", line[line.index("[") : line.index("]") + 1])
        assert math.dist(start[:3], moved[:3]) == pytest.approx(math.dist((x, y, z), (0, 0, 0.01)), abs=1e-4)
        hand.rebuilt()
        assert hand.pose("gripper/base") == pytest.approx(moved, abs=1e-4)

        page.keyboard.press("m")
        hand.select("gripper/base")
        before = hand.text
        hand.turn()
        turned = hand.pose("gripper/base")
        text = hand.changed(before)
        angles = next(each for each in text.splitlines() if "euler" in each)
        assert "euler: [0, 0, 45]" not in angles and text == before.replace("    euler: [0, 0, 45]", angles)
        hand.rebuilt()
        assert hand.pose("gripper/base") == pytest.approx(turned, abs=1e-4)

        page.evaluate("mjcompose.world.pose.qpos[1] = 0.5; mjcompose.moved()")
        before = hand.text
        page.get_by_role("tab", name="Joints").click()
        page.get_by_role("button", name="Save this pose in the recipe").click()
        page.get_by_label("name of the keyframe").fill("reach")
        page.get_by_role("button", name="Save", exact=True).click()
        text = hand.changed(before)
        assert (
            text.startswith(before) and "keyframe:\n  reach:\n    qpos:\n" in text and text.endswith("    ctrl: hold\n")
        )
        hand.rebuilt()
        assert page.evaluate("mjcompose.world.model.scene.key.name").count("reach") == 1

        for expected in (before, before.replace(angles, "    euler: [0, 0, 45]"), RECIPE):
            text = hand.text
            page.keyboard.press("Control+z")
            assert hand.changed(text) == expected
        page.keyboard.press("Control+Shift+z")
        again = hand.changed(RECIPE)
        assert "[0, 0, 0.01]" not in again
        page.keyboard.press("Control+z")
        assert hand.changed(again) == RECIPE
        page.keyboard.press("Control+y")
        assert hand.changed(RECIPE) == again


@pytest.mark.slow
def test_a_number_is_typed_and_a_part_is_dropped_on_a_site(folder: Path, open_page: Callable[..., Any]) -> None:
    with running("cell.yaml", folder) as server:
        page = open_page(server.address)
        hand = Mouse(page, folder / "cell.yaml", server.workshop)
        page.keyboard.press("r")  # the cube is free, and a keyframe would have a place for it
        page.keyboard.press("m")
        hand.select("cube/cube")
        page.get_by_label("x, relative to its place").fill("0.2512")
        page.keyboard.press("Enter")
        assert hand.changed(RECIPE) == RECIPE.replace("[0.15, 0, 0.75]", "[0.2512, 0, 0.75]")
        hand.rebuilt()
        hand.select("arm/base")
        assert page.get_by_label("what moves").locator("option").all_inner_texts() == ["arm", "table"]
        before = hand.text
        # The middle of the handle moves in the plane of the picture.
        x, y = page.evaluate(AT, [[0, 0, 0], 0])
        there = page.evaluate("""() => {
          const { scene } = mjcompose.world.model, { camera, canvas } = mjcompose.stage, box = canvas.getBoundingClientRect();
          const point = mjcompose.stage.camera.position.clone().setFromMatrixPosition(mjcompose.world.matrixOf('site', scene.site.name.indexOf('table/corner'))).project(camera);
          return [box.left + (point.x + 1) * box.width / 2, box.top + (1 - point.y) * box.height / 2];
        }""")
        hand.drag([[0, 0, 0]], "XYZ", 0, lambda number: [there[0] - x, there[1] - y])
        assert hand.changed(before) == before.replace("site: table/mount}", "site: table/corner}")


@pytest.mark.slow
def test_a_page_that_is_read_only_has_no_handles(folder: Path, open_page: Callable[..., Any]) -> None:
    with running("cell.yaml", folder) as server:
        server.workshop.writes = False
        server.workshop.build()
        page = open_page(server.address)
        assert page.get_by_title("move (M)").is_hidden()
        page.keyboard.press("m")
        assert page.locator(".gizmo").is_hidden() and "read-only" in page.locator(".toast").inner_text()


@pytest.mark.slow
def test_the_page_asks_before_it_writes_an_edit_or_a_keyframe(folder: Path, open_page: Callable[..., Any]) -> None:
    keyed = RECIPE + "keyframe:\n  home: {qpos: {cube/free: [0.15, 0, 0.8, 1, 0, 0, 0]}}\n"
    (folder / "cell.yaml").write_text(keyed)
    with running("cell.yaml", folder) as server:
        page = open_page(server.address)
        hand = Mouse(page, folder / "cell.yaml", server.workshop)
        page.keyboard.press("m")
        for kind, name in (("site", "arm/attachment_site"), ("body", "arm/elbow")):
            page.evaluate(
                "([kind, name]) => mjcompose.select({kind, index: mjcompose.world.model.scene[kind].name.indexOf(name)}, true)",
                [kind, name],
            )
            page.get_by_label("what moves").select_option(label=f"{name}, by an edit")
            hand.until("mjcompose.gizmo.controls.object !== undefined")
            before = hand.text
            start = page.get_by_label("z, relative to its place").input_value()
            page.get_by_label("z, relative to its place").fill("0.2")
            page.keyboard.press("Enter")
            page.get_by_role("button", name="Cancel").click()
            hand.until(f"""document.querySelector('[aria-label^="z, relative"]').value === '{start}'""")
            assert hand.text == before
            page.get_by_label("z, relative to its place").fill("0.2")
            page.keyboard.press("Enter")
            assert f"select: {{{kind}: {name}}}" in page.locator("dialog pre").inner_text()
            page.get_by_role("button", name="Write it").click()
            assert f"select: {{{kind}: {name}}}" in hand.changed(before)
            hand.rebuilt()
        page.evaluate("mjcompose.setKey(mjcompose.world.model.scene.key.name.indexOf('home'))")
        hand.select("cube/cube")
        for answer, expected in (
            ("Write keyframe home", "cube/free: [0.15, 0.1, 0.8,"),
            ("Write the place", "pos: [0.15, 0.1, 0.75]"),
        ):
            before = hand.text
            page.get_by_label("y, relative to its place").fill("0.1")
            page.keyboard.press("Enter")
            page.get_by_role("button", name=answer).click()
            assert expected in hand.changed(before), hand.text
            hand.rebuilt()


@pytest.mark.slow
def test_what_is_computed_or_changed_elsewhere_is_refused(folder: Path, open_page: Callable[..., Any]) -> None:
    recipe = RECIPE.replace("pos: [0.15, 0, 0.75]", 'pos: ["${x}", 0, 0.75]') + "params: {x: 0.15}\n"
    (folder / "cell.yaml").write_text(recipe)
    with running("cell.yaml", folder) as server:
        page = open_page(server.address)
        hand = Mouse(page, folder / "cell.yaml", server.workshop)
        page.keyboard.press("m")
        page.evaluate(
            "mjcompose.select({kind: 'body', index: mjcompose.world.model.scene.body.name.indexOf('cube/cube')}, true)"
        )
        page.get_by_label("parameter x", exact=True).fill("0.3")
        assert "`pos` is computed: `${x}`" in page.locator(".gizmo .words").inner_text()
        page.keyboard.press("Enter")
        assert hand.changed(recipe) == recipe.replace("params: {x: 0.15}", "params: {x: 0.3}")
        hand.rebuilt()

        hand.select("gripper/base")
        server.workshop.build = lambda: server.workshop.shown  # type: ignore[method-assign]
        other = hand.text + "# mine\n"
        hand.recipe.write_text(other)
        start = hand.pose("gripper/base")
        hand.drag([[0, 0, 1]], "Z", 0.55, lambda number: [0, -60])
        page.locator(".gizmo .words", has_text="has changed since this model was built").wait_for()
        assert hand.text == other and hand.pose("gripper/base") == pytest.approx(start, abs=1e-9)


class _Other(BaseHTTPRequestHandler):
    """A page of somebody else on this machine."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<!doctype html><title>other</title>")

    def log_message(self, format: str, *args: Any) -> None:
        pass


@pytest.mark.slow
def test_a_page_of_another_origin_changes_nothing_even_with_the_token(folder: Path, browser: Any) -> None:
    other = ThreadingHTTPServer(("127.0.0.1", 0), _Other)
    Thread(target=other.serve_forever, daemon=True).start()
    page = browser.new_page()
    with running("cell.yaml", folder) as server:
        while server.workshop.shown.version < 0:
            time.sleep(0.05)
        row = next(
            each for each in json.loads(server.workshop.shown.text)["move"]["targets"] if each["label"] == "gripper"
        )
        body = json.dumps(
            {"kind": "place", "version": 0, "at": ["cell.yaml", *row["at"][1:]], "pos": [0, 0, 1], "quat": [1, 0, 0, 0]}
        )
        sends = """([address, body, mode, type]) => fetch(address + "change", {method: "POST", body, mode, headers: {"content-type": type}})
          .then((answer) => `${answer.type} ${answer.status}`).catch(() => "failed")"""
        for host in ("127.0.0.1", "localhost"):
            page.goto(f"http://{host}:{other.server_address[1]}/")
            for mode in ("cors", "no-cors"):
                for kind in ("application/json", "text/plain"):
                    assert page.evaluate(sends, [server.address, body, mode, kind]) in ("failed", "opaque 0")
        assert (folder / "cell.yaml").read_text() == RECIPE
        page.goto(server.address)
        assert page.evaluate(sends, [server.address, body, "cors", "application/json"]) == "basic 200"
        assert (folder / "cell.yaml").read_text() != RECIPE
    page.close()
    other.shutdown()


@pytest.mark.slow
def test_a_model_to_attach_is_searched_and_a_refusal_is_in_the_dialog(
    folder: Path, open_page: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = folder / "robots" / "fine_robot"
    robot.mkdir(parents=True)
    (robot / "fine_hand.xml").write_text("<mujoco/>")
    monkeypatch.setenv("MENAGERIE_ROOT", str(folder / "robots"))
    with running("cell.yaml", folder) as server:
        page = open_page(server.address)
        hand = Mouse(page, folder / "cell.yaml", server.workshop)
        page.evaluate(
            "mjcompose.select({kind: 'site', index: mjcompose.world.model.scene.site.name.indexOf('table/corner')}, true)"
        )
        page.get_by_role("button", name="Attach here…").first.click()
        models = page.get_by_label("model", exact=True).locator("option")
        models.first.wait_for(state="attached")
        assert models.count() > 5
        page.get_by_label("search models").fill("FINE menagerie")
        assert models.all_inner_texts() == ["menagerie:fine_robot/fine_hand"]
        page.get_by_label("search models").fill("cube.xml")
        assert models.all_inner_texts() == ["./models/props/cube.xml"]
        before = hand.text
        page.get_by_label("name of the part").fill("gripper")
        page.get_by_role("button", name="Attach", exact=True).click()
        page.locator("dialog .refused", has_text="there is a part `gripper`").wait_for()
        assert hand.text == before
        page.get_by_label("name of the part").fill("second")
        page.get_by_role("button", name="Attach", exact=True).click()
        assert "second: {model: ./models/props/cube.xml, site: table/corner}" in hand.changed(before)
        page.locator("dialog").wait_for(state="detached")
