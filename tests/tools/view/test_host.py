"""A page in an editor, which carries what it asks for and follows the cursor."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tools.view.test_live import running

ARM = """<mujoco>
  <worldbody>
    <body name="arm">
      <joint name="elbow"/>
      <geom name="ball" size="0.1"/><site name="flange"/>
    </body>
  </worldbody>
</mujoco>"""
RECIPE = """recipe: 1
base: ./arm.xml
attach:
  left:
    model: ./arm.xml
    site: flange
  right:
    model: ./arm.xml
    site: flange
edit:
  - select: {geom: ball}
    set: {rgba: [1, 0, 0, 1]}
"""
# What an editor gives a page: here the requests are the page's own.
HOST = """
window.opened = [];
window.mjcomposeHost = {
  theme: "dark",
  get: async (path) => (await fetch(path)).arrayBuffer(),
  post: async (path, data) => { await fetch(path, {method: "POST", headers: {"content-type": "application/json"}, body: JSON.stringify(data)}); },
  listen: (event) => { const events = new EventSource("events"); for (const name of ["model", "fault", "state"]) events.addEventListener(name, (said) => event(name, JSON.parse(said.data))); },
  open: (...place) => opened.push(place),
  follow: (theme, reveal) => { window.theme = theme; window.reveal = reveal; },
};
"""


@pytest.mark.slow
def test_links_open_in_the_editor_and_its_cursor_selects(tmp_path: Path, browser: Any) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "arm.yaml").write_text(RECIPE)
    model = str(tmp_path / "arm.xml")
    recipe = str(tmp_path / "arm.yaml")
    with running("arm.yaml", tmp_path) as server:
        page = browser.new_page()
        page.add_init_script(HOST)
        page.goto(server.address)
        page.wait_for_selector("html[data-shown='1'][data-theme='dark']", state="attached", timeout=60_000)
        selected = _selects(page)

        assert selected(model, [[4, 7], [3, 5], [2, 3]]) == "joint elbow"
        assert selected(model, [[5, 30]]) == "geom ball"
        assert selected(model, [[5, 60], [3, 5]]) == "site flange"
        assert selected(model, [[6, 5], [3, 5]]) == "body arm"
        page.locator("a.place").first.click()
        assert page.evaluate("opened") == [[model, 3, 5]]

        assert selected(recipe, [[8, 5], [7, 3], [3, 1]]) == "body right/arm"
        assert selected(model, [[3, 5]]) == "body right/arm"  # the file is used thrice: what is selected stays
        assert selected(recipe, [[12, 5], [12, 32]]) == "geom ball"
        assert selected(recipe, [[1, 1]]) == "geom ball"  # nothing is written there
        assert selected("/elsewhere/arm.xml", [[3, 5]]) == "geom ball"
        page.evaluate("theme('light')")
        assert page.locator("html[data-theme='light']").count() == 1
        page.close()


def _selects(page: Any) -> Callable[[str, list[list[int]]], str]:
    """Moves the cursor; gives what is selected then."""

    def selected(file: str, places: list[list[int]]) -> str:
        page.evaluate("([file, places]) => reveal([file], places)", [file, places])
        return str(
            page.evaluate(
                "mjcompose.selection.kind + ' ' + mjcompose.world.model.scene[mjcompose.selection.kind].name[mjcompose.selection.index]"
            )
        )

    return selected


ASKS = """
window.texts = {};
window.edits = [];
mjcomposeHost.ask = async (path, data) => {
  const body = JSON.stringify({...data, texts}), headers = {"content-type": "application/json"};
  const answer = await (await fetch(path, {method: "POST", headers, body})).json();
  edits.push(...(answer.edits ?? []));
  return answer;
};
"""


@pytest.mark.slow
def test_an_editor_changes_its_own_text_and_an_older_one_has_no_handles(tmp_path: Path, browser: Any) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    recipe = tmp_path / "arm.yaml"
    recipe.write_text(RECIPE)
    with running("arm.yaml", tmp_path) as server:
        for script in (HOST, HOST + ASKS):
            page = browser.new_page()
            page.add_init_script(script)
            page.goto(server.address)
            page.wait_for_selector("html[data-shown='1']", state="attached", timeout=60_000)
            assert page.get_by_title("move (M)").is_visible() == (script != HOST)
            if script != HOST:
                page.evaluate("([file, text]) => { texts[file] = text; }", [str(recipe), f"# unsaved\n{RECIPE}"])
                page.keyboard.press("m")
                page.evaluate(
                    "mjcompose.select({kind: 'body', index: mjcompose.world.model.scene.body.name.indexOf('left/arm')}, true)"
                )
                page.get_by_label("x, relative to its place").fill("0.5")
                page.keyboard.press("Enter")
                page.locator(".toast", has_text="left: pos: [0.5, 0, 0]").wait_for()
                (edit,) = page.evaluate("edits")
                assert edit == {"file": str(recipe), "range": [7, 2, 7, 2], "text": "  pos: [0.5, 0, 0]\n  "}
            page.close()
    assert recipe.read_text() == RECIPE
