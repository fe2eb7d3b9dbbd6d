"""Makes docs/pictures/editor.gif and editors/vscode/picture.png: a recipe is written in VS Code, with the real server.

    make vscode
    python docs/pictures/screencast.py CODE_SERVER

CODE_SERVER is the `out/node/entry.js` of an installed code-server (npm), which is VS Code in a browser. Chromium draws
it and types what a person would; each name is chosen from what the server offers, and a name that it does not offer
ends the program. The film runs as fast as it happened, except that long waits are cut.
"""

from __future__ import annotations

import base64
import shutil
import sys
import tempfile
from contextlib import suppress
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Error

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from editors.code_server import code_server  # noqa: E402

GIF = ROOT / "docs" / "pictures" / "editor.gif"
PICTURE = ROOT / "editors" / "vscode" / "picture.png"
FILE = "cell.recipe.yaml"
SIZE = {"width": 1120, "height": 630}
COLORS = 160
KEY_SECONDS = 0.055
LOOK_SECONDS = 0.8
LONGEST = 1.6
SHORTEST = 0.08
SETTINGS = {
    "[mjcompose-recipe]": {"editor.tabSize": 2},
    "breadcrumbs.enabled": False,
    "editor.cursorBlinking": "solid",
    "editor.fontSize": 14,
    "editor.lineNumbersMinChars": 3,
    "editor.minimap.enabled": False,
    "editor.occurrencesHighlight": "off",
    "editor.stickyScroll.enabled": False,
    "files.autoSave": "off",
    "window.commandCenter": False,
    "workbench.activityBar.location": "hidden",
    "workbench.colorTheme": "Default Light Modern",
    "workbench.layoutControl.enabled": False,
    "workbench.sideBar.location": "right",
}


class Film:
    """The frames of a page with their times, while `wait` lets it run."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.frames = list[tuple[float, bytes]]()
        self._session = page.context.new_cdp_session(page)
        self._session.on("Page.screencastFrame", self._take)
        self._session.send("Page.startScreencast", {"format": "png"})

    def _take(self, frame: dict[str, Any]) -> None:
        self.frames.append((frame["metadata"]["timestamp"], base64.b64decode(frame["data"])))
        self._session.send("Page.screencastFrameAck", {"sessionId": frame["sessionId"]})

    def wait(self, seconds: float) -> None:
        self.page.wait_for_timeout(1000 * seconds)

    def press(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)
            self.wait(KEY_SECONDS)

    def type(self, text: str) -> None:
        for key in text:
            self.page.keyboard.type(key)
            self.wait(KEY_SECONDS)

    def line(self, text: str, outwards: int = 0) -> None:
        """A new line, `outwards` steps less indented than the editor makes it."""
        self.press("Escape", "Enter", *["Backspace"] * outwards)
        self.type(text)

    def choose(self, label: str, typed: str = "") -> None:
        """Take a name from the list that the editor shows, after some letters of it."""
        self.wait(LOOK_SECONDS / 2)
        self.type(typed)
        rows = self.page.locator(".suggest-widget.visible .monaco-list-row")
        wanted = rows.filter(has_text=label).first
        if not rows.count():
            self.press("Control+Space")
        wanted.wait_for(timeout=20_000)
        self.wait(LOOK_SECONDS)
        for _ in range(40):
            if "focused" in (wanted.get_attribute("class") or ""):
                break
            self.press("ArrowDown")
        self.wait(LOOK_SECONDS / 2)
        self.press("Enter")

    def write(self, path: Path) -> None:
        """The film as a GIF with one palette."""
        self._session.send("Page.stopScreencast")
        kept: list[tuple[float, bytes]] = []
        for at, frame in self.frames:
            if kept and at - kept[-1][0] < SHORTEST:
                kept[-1] = (kept[-1][0], frame)
            else:
                kept.append((at, frame))
        images = [Image.open(BytesIO(frame)).convert("RGB") for _, frame in kept]
        palette = images[-1].quantize(COLORS)
        times = [at for at, _ in kept] + [kept[-1][0] + 3]
        lasts = [round(1000 * min(LONGEST, after - at)) for at, after in pairwise(times)]
        lasts[-1] = 3000
        drawn = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
        drawn[0].save(path, save_all=True, append_images=drawn[1:], duration=lasts, loop=0, optimize=True)
        size = path.stat().st_size / 1e6
        sys.stdout.write(f"{path.name}: {len(drawn)} frames, {sum(lasts) / 1000:.0f} s, {size:.2f} MB\n")


def play(film: Film) -> None:
    """Write a recipe for two arms, a table and a tool."""
    page = film.page
    film.type("recipe: 1")
    film.line("name: cell")
    film.line("base: ")
    film.choose("./models/scenes/floor.xml", "fl")
    film.line("")
    film.line("attach:")
    film.line("table:")
    film.line("model: ")
    film.choose("./models/table/table.xml", "tab")
    film.line("left:", outwards=1)
    film.line("model: ")
    film.choose("./models/arm6/arm6.xml", "arm")
    film.line("body: ")
    film.choose("table/table")
    film.line("pos: [-0.4, 0.25, 0.75]")
    film.press("Control+s")
    page.get_by_label("mjcompose: View").or_(page.get_by_label("View", exact=True)).first.click()
    shown(page, 1)
    film.wait(LOOK_SECONDS)
    film.press("Control+1")
    film.line("right:", outwards=1)
    film.line("model: ")
    film.choose("./models/arm6/arm6.xml", "arm")
    film.line("body: ")
    film.choose("table/table")
    film.line("pos: [-0.4, -0.25, 0.75]")
    film.press("Control+s")
    shown(page, 2)
    film.wait(LOOK_SECONDS)
    film.line("tool:", outwards=1)
    film.line("model: ")
    film.choose("./models/gripper2/gripper2.xml", "gr")
    film.line("site: ")
    film.choose("left/attachment_site", "att")
    film.press("Control+s")
    shown(page, 3)
    film.wait(2 * LOOK_SECONDS)
    page.get_by_text("left/attachment_site", exact=True).last.hover()
    film.wait(5 * LOOK_SECONDS)


def shown(page: Any, models: int) -> None:
    """Wait until the page beside the text has shown so many models."""
    for _ in range(600):
        for frame in page.frames:
            with suppress(Error):  # a frame that goes while it is asked
                if frame != page.main_frame and frame.locator(f"html[data-shown='{models}']").count():
                    return
        page.wait_for_timeout(100)
    raise SystemExit(f"model {models} is not shown")


def main(entry: str) -> None:
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home, "lab")
        shutil.copytree(ROOT / "recipes" / "models", folder / "models")
        (folder / FILE).touch()
        package = max((ROOT / "build").glob("mjcompose-*.vsix"), key=lambda path: path.stat().st_mtime)
        with code_server(entry, Path(home), folder, SETTINGS, [package]) as (address, browser):
            page = browser.new_page(viewport=SIZE)
            page.goto(address)
            begin(page)
            film = Film(page)
            try:
                play(film)
            finally:
                shot = Image.open(BytesIO(page.screenshot())).convert("RGB")
                shot.quantize(COLORS).save(PICTURE, optimize=True)
            film.write(GIF)
        sys.stdout.write((folder / FILE).read_text())


def begin(page: Any) -> None:
    """Open the empty recipe, as soon as the extension and its server can be had."""
    entry = page.get_by_text(FILE, exact=True).first
    entry.wait_for(timeout=60_000)
    page.wait_for_timeout(5000)
    entry.dblclick()
    page.keyboard.press("Control+b")
    page.locator(".monaco-editor textarea, .native-edit-context").first.focus(timeout=60_000)
    page.wait_for_timeout(6000)


if __name__ == "__main__":
    main(sys.argv[1])
