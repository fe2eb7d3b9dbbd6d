"""From a saved file to a picture in the browser, and pictures without one, against what they may take.

Seconds and not ratios to a peer: measured on a machine that has nothing else to do, or not at all.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from statistics import median
from typing import Any

from bench.models import REPOSITORY
from bench.row import Row

_BROWSERS = ("chromium", "chromium-browser", "google-chrome")
_FLAGS = "--no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader".split()
_ROUNDS = 20
_FIRST = 2.5
_PICTURE = 0.5
_ZIP = 0.3
_UR5E = """recipe: 1
base: menagerie:universal_robots_ur5e/ur5e
attach:
  gripper: {model: menagerie:robotiq_2f85/2f85, site: attachment_site, pos: [0, 0, 0.0]}
option: {impratio: 10, cone: elliptic, integrator: implicitfast}
"""
_SHOWN = """count => new Promise(done => {
  const root = document.documentElement;
  const look = () => { if (Number(root.dataset.shown ?? 0) >= count) done(); };
  new MutationObserver(look).observe(root, { attributes: true });
  look();
})"""


_HANDLE = """([name, far]) => {
  const { gizmo, stage: { camera, canvas }, world } = mjcompose, body = world.model.scene.body.name.indexOf(name);
  if (name) { mjcompose.select({ kind: "body", index: body }, false); return null; }
  if (!gizmo.controls.object) return null;
  gizmo.handle.updateMatrixWorld(true);
  const V = camera.position.constructor, at = new V().setFromMatrixPosition(gizmo.handle.matrixWorld);
  const size = at.distanceTo(camera.position) * Math.min(1.9 * Math.tan(Math.PI * camera.fov / 360), 7) / 4;
  const { x, y } = new V(0, 0, far * size).applyMatrix4(gizmo.handle.matrixWorld).project(camera);
  const { left, top, width, height } = canvas.getBoundingClientRect(), hovers = gizmo.controls.axis === "Z";
  return [left + (x + 1) * width / 2, top + (1 - y) * height / 2, hovers];
}"""
_DRAWN = """before => new Promise(done => {
  const look = () => { if (mjcompose.stage.frames > before) done(); else requestAnimationFrame(look); };
  look();
})"""
_MOVED = 0.3
_WRITTEN = 0.3


def rows() -> Iterator[Row]:
    yield _sheet()
    yield from _watched()
    with _browser() as browser:
        if browser is None:
            yield Row("save to pixels", None, None, "no Chromium, or playwright is not installed")
            return
        yield from _saves(browser)
        yield _many(browser)


def _watched() -> Iterator[Row]:
    """`build --watch`: from a save to the zip, and to the end of the run."""
    if not (os.environ.get("MENAGERIE_ROOT") or os.environ.get("MJCOMPOSE_CORPUS")):
        yield Row("save to zip with --watch", None, 1.0, "MENAGERIE_ROOT is not set")
        return
    recipe = Path("watched.yaml").absolute()
    recipe.write_text(_UR5E)
    process = subprocess.Popen(
        [sys.executable, "-m", "mjcompose", "build", str(recipe), "--watch", "-o", "watched.zip"],
        env=_environment(),
        text=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    assert process.stderr is not None
    seconds: list[float] = []
    started = 0.0
    try:
        for count in range(_ROUNDS):
            while not process.stderr.readline().startswith("watching"):
                assert process.poll() is None
            if count:
                seconds.append(time.perf_counter() - started)
            time.sleep(0.1)
            started = time.perf_counter()
            recipe.write_text(_UR5E.replace("0.0]}", f"0.{count + 20}]}}"))
    finally:
        process.terminate()
        process.communicate()
    yield _row("ur5e + 2f85", seconds, _ZIP, "save to zip with build --watch")


def _sheet() -> Row:
    """Nine and three pictures of one recipe: what starting takes is in both."""
    seconds = {count: min(_rendered(count) for _ in range(2)) for count in (3, 9)}
    each = (seconds[9] - seconds[3]) / 6
    return Row("a picture of a contact sheet", each / _PICTURE, 1.0, f"{each * 1e3:.0f} of {_PICTURE * 1e3:.0f} ms")


def _rendered(count: int) -> float:
    samples = [word for number in range(count) for word in ("--sample", str(number))]
    started = time.perf_counter()
    _command("render", REPOSITORY / "recipes" / "randomised.yaml", "-o", "sheet.png", *samples, "-q")
    return time.perf_counter() - started


def _saves(browser: Any) -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(REPOSITORY / "recipes", Path(folder, "recipes"))
        demo = Path(folder, "recipes", "demo.yaml")
        first, saves = _shown(browser, demo, "pos: [0.15, ", "pos: [0.{}, ")
        yield Row("first picture, cold: demo", first / _FIRST, 1.0, f"{first:.2f} of {_FIRST} s")
        yield _row("demo", saves, 0.25)
        yield from _drags(browser, demo, "gripper/base")
        if os.environ.get("MENAGERIE_ROOT") or os.environ.get("MJCOMPOSE_CORPUS"):
            ur5e = Path(folder, "ur5e_2f85.yaml")
            ur5e.write_text(_UR5E)
            yield _row("ur5e + 2f85", _shown(browser, ur5e, "0.0]}", "0.{}]}}")[1], 0.6)
            yield from _drags(browser, ur5e, "gripper/base_mount")


def _row(name: str, seconds: list[float], limit: float, what: str = "save to pixels") -> Row:
    middle = median(seconds)
    span = f"{min(seconds) * 1e3:.0f} to {max(seconds) * 1e3:.0f}"
    return Row(f"{what}: {name}", middle / limit, 1.0, f"median {middle * 1e3:.0f} ms of {len(seconds)}, {span}")


@contextmanager
def _viewed(browser: Any, recipe: Path) -> Iterator[tuple[Any, float]]:
    """A page of a recipe, and the seconds from the start of the command to its first picture."""
    started = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-m", "mjcompose", "view", str(recipe), "--no-open"],
        cwd=recipe.parent,
        env=_environment(),
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    page = browser.new_page(viewport={"width": 1100, "height": 640})
    try:
        assert process.stdout is not None
        address = next((line.strip() for line in process.stdout if line.startswith("http")), "")
        page.goto(address)
        page.evaluate(_SHOWN, 1)
        yield page, time.perf_counter() - started
    finally:
        page.close()
        process.terminate()
        process.wait()


def _shown(browser: Any, recipe: Path, old: str, new: str) -> tuple[float, list[float]]:
    """Seconds from the start of the command to the first picture, and from each save to its own."""
    with _viewed(browser, recipe) as (page, first):
        text = recipe.read_text()
        saves = []
        for count in range(_ROUNDS):
            time.sleep(0.1)
            started = time.perf_counter()
            recipe.write_text(text.replace(old, new.format(20 + count)))
            page.evaluate(_SHOWN, count + 2)
            saves.append(time.perf_counter() - started)
    return first, saves


def _drags(browser: Any, recipe: Path, body: str) -> Iterator[Row]:
    """A part is dragged by its handle: from the mouse to the picture, and from the release to the recipe's new text."""
    with _viewed(browser, recipe) as (page, _):
        page.keyboard.press("m")
        page.evaluate(_HANDLE, [body, 0])
        moves = []
        releases = []
        models = []
        for count in range(_ROUNDS // 4):
            while not (found := page.evaluate(_HANDLE, ["", 0.5])) or not found[2]:
                if found:
                    page.mouse.move(found[0] - 1, found[1])
                    page.mouse.move(found[0], found[1])
                page.wait_for_timeout(100)
            before = recipe.read_bytes()
            page.mouse.down()
            for step in range(1, 6):
                frames = page.evaluate("mjcompose.stage.frames")
                started = time.perf_counter()
                page.mouse.move(found[0], found[1] + (10 if count % 2 else -10) * step)
                page.evaluate(_DRAWN, frames)
                moves.append(time.perf_counter() - started)
            started = time.perf_counter()
            page.mouse.up()
            while recipe.read_bytes() == before:
                time.sleep(0.002)
            releases.append(time.perf_counter() - started)
            page.evaluate(_SHOWN, count + 2)
            models.append(time.perf_counter() - started)
    yield _row(recipe.stem, moves, _MOVED, "drag to pixels")
    yield _row(recipe.stem, releases, _WRITTEN, "release to the recipe's new text")
    yield _row(recipe.stem, models, 1.0, "release to the new model shown")


def _many(browser: Any) -> Row:
    """Ten thousand geoms; without a GPU it shall open, whatever that takes."""
    kinds = ("box", "sphere", "capsule")
    geoms = "".join(
        f'<body pos="{number % 100} {number // 100} 0"><geom type="{kinds[number % 3]}" size=".3 .3 .3"/></body>'
        for number in range(10_000)
    )
    Path("many.xml").write_text(f"<mujoco><worldbody>{geoms}</worldbody></mujoco>")
    _command("view", "many.xml", "--html", "many.html", "-q")
    page = browser.new_page(viewport={"width": 1100, "height": 640})
    started = time.perf_counter()
    page.goto(Path("many.html").absolute().as_uri())
    page.evaluate(_SHOWN, 1)
    seconds = time.perf_counter() - started
    page.close()
    return Row("a page of 10,000 geoms opens", None, None, f"in {seconds:.1f} s, drawn by the processor")


@contextmanager
def _browser() -> Iterator[Any]:
    program = next(filter(None, map(shutil.which, _BROWSERS)), None)
    try:
        playwright = import_module("playwright.sync_api")
    except ImportError:
        program = None
    if program is None:
        yield None
        return
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=program, headless=True, args=_FLAGS)
        yield browser
        browser.close()


def _command(*words: str | Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "mjcompose", *map(str, words)], env=_environment(), check=False, capture_output=True
    )


def _environment() -> dict[str, str]:
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    known = {"MENAGERIE_ROOT": str(Path(corpus) / "models")} if corpus and not os.environ.get("MENAGERIE_ROOT") else {}
    return {**os.environ, **known, "PYTHONPATH": str(REPOSITORY)}
