"""Two models in one page."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.contrast.text import render
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import diff
from mjcompose.tools.view.page import difference, write_comparison
from tools.view.pages import page_of

PARTS = """
  <body name="still"><geom name="still" size="0.1"/></body>
  <body name="lid" pos="0 0 {place}"><geom name="lid" type="box" size="0.1 0.1 0.01"/>
    <body name="handle" pos="0 0 0.1"><geom name="handle" size="0.02"/></body></body>
  <body name="jar" pos="0.5 0 0"><geom name="jar" size="0.1" mass="{mass}"/></body>
  <geom name="paint" type="box" size="0.1 0.1 0.1" pos="1 0 0" material="paint"/>
  {more}
"""
MODEL = (
    """<mujoco>
  <asset><material name="paint" rgba="{rgba}"/></asset>
  <worldbody>"""
    + PARTS
    + """</worldbody>
</mujoco>
"""
)
GONE = '<body name="gone" pos="0 1 0"><geom name="gone" size="0.1"/></body>'
NEW = '<body name="new" pos="0 -1 0"><geom name="new" type="box" size="0.1 0.2 0.3" mass="7"/></body>'
WHAT = """() => Object.fromEntries(mjcompose.world.model.scene.geom.name.map(
    (name, index) => [name, mjcompose.contrast.of({kind: "geom", index})]))"""

COLOR = """() => Object.fromEntries(mjcompose.world.batches.filter(each => each.kind === "geom").flatMap(
    ({ mesh, members }) => members.map((index, at) => [mjcompose.world.model.scene.geom.name[index],
        Array.from(mesh.instanceColor.array.slice(3 * at, 3 * at + 3)).map(each => Number(each.toFixed(2)))])))"""


@pytest.fixture
def page(tmp_path: Path) -> Path:
    """The page of two models, of files that the user names by absolute paths."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    before = MODEL.format(place=0.3, mass=1, rgba="1 0 0 1", more=GONE)
    (tmp_path / "a" / "model.xml").write_text(before)
    (tmp_path / "b" / "model.xml").write_text(MODEL.format(place=0.4, mass=2, rgba="0 0 1 1", more=NEW))
    return compared(str(tmp_path / "a" / "model.xml"), str(tmp_path / "b" / "model.xml"), tmp_path)


def compared(a: str, b: str, folder: Path) -> Path:
    (folder / "elsewhere").mkdir(exist_ok=True)
    context = Context(folder=folder / "elsewhere")
    with Session() as session:

        def show(first: Any, second: Any, found: Any) -> None:
            assert write_comparison(first, second, found, folder / "page.html", context, session)

        assert diff(a, b, context, session, show=show) is not None, context.sink.diagnostics
    return folder / "page.html"


@pytest.mark.slow
def test_what_differs_is_colored_on_both_sides(page: Path, open_page: Callable[..., Any]) -> None:
    shown = open_page(page.as_uri())
    same = {"still": None, "lid": "moved", "handle": "moved", "jar": "changed", "paint": "changed"}
    assert shown.evaluate(WHAT) == {**same, "new": "added"}
    drawn = shown.evaluate(COLOR)
    assert drawn["still"] == [0.5, 0.5, 0.5] and drawn["new"] == [0.18, 0.75, 0.36]
    assert shown.locator(".difference pre").inner_text().startswith("A model.xml\nB b/model.xml\ndifferent: ")
    shown.get_by_role("button", name="before").click()
    shown.wait_for_selector("html[data-shown='2']", state="attached")
    assert shown.evaluate(WHAT) == {**same, "gone": "removed"}
    shown.keyboard.press("x")
    shown.wait_for_selector("html[data-shown='3']", state="attached")
    shown.locator(".difference summary", has_text="added").click()
    shown.get_by_role("link", name="body new").click()
    assert shown.evaluate("mjcompose.selection.kind") == "body"


@pytest.mark.slow
def test_a_textured_thing_is_colored_too(tmp_path: Path, open_page: Callable[..., Any]) -> None:
    assets = '<asset><texture name="t" type="2d" builtin="flat" rgb1="0 0 0" width="8" height="8"/><material name="m" texture="t"/></asset>'
    model = f'<mujoco>{assets}<worldbody><body name="b"><geom type="box" size="1 1 1" mass="{{}}" material="m"/></body></worldbody></mujoco>'
    for name, mass in (("a", 1), ("b", 2)):
        (tmp_path / f"{name}.xml").write_text(model.format(mass))
    shown = open_page(compared(str(tmp_path / "a.xml"), str(tmp_path / "b.xml"), tmp_path).as_uri())
    assert shown.evaluate("mjcompose.world.tinted.map(each => each.mesh.material.color.getHex())") == [0xF5A524]


def test_the_page_has_no_path_of_the_machine(page: Path, tmp_path: Path) -> None:
    from tools.view.pages import unpacked

    text = page.read_text(encoding="utf-8")
    models = unpacked(text)
    assert len(models) == 2 and "difference" in models[1]
    assert all(str(tmp_path) not in each for each in (text, *models))
    first = page.read_bytes()
    shutil.move(tmp_path / "page.html", tmp_path / "other.html")
    again = compared(str(tmp_path / "a" / "model.xml"), str(tmp_path / "b" / "model.xml"), tmp_path)
    assert again.read_bytes() == first


def test_the_text_is_that_of_the_terminal(tmp_path: Path) -> None:
    for name, mass in (("a", 1), ("b", 2)):
        model = MODEL.format(place=0, mass=mass, rgba="1 1 1 1", more="")
        (tmp_path / f"{name}.xml").write_text(model)
    context = Context(folder=tmp_path)
    with Session() as session:
        found = diff("a.xml", "b.xml", context, session)
    assert found is not None
    assert difference(found)["text"] == render(found)
    assert difference(found)["before"] == {"removed": [], "changed": ["body 4"], "moved": []}


@pytest.mark.slow
def test_an_arm_and_a_gripper_are_a_small_page(corpus: Path, tmp_path: Path) -> None:
    recipe = (
        f"recipe: 1\nattach:\n  arm: {{model: {corpus}/models/universal_robots_ur5e/ur5e.xml, drop: [option]}}\n"
        f"  gripper: {{model: {corpus}/models/robotiq_2f85/2f85.xml, site: arm/attachment_site, drop: [option]}}\n"
    )
    (tmp_path / "recipe.yaml").write_text(recipe)
    with Session() as session:
        page = page_of("recipe.yaml", tmp_path, session)
        assert page.stat().st_size < 1_250_000, "260 thousand triangles"
        played = page_of("recipe.yaml", tmp_path, session, physics=True)
        assert played.stat().st_size < 6_200_000, "3.5 MB of MuJoCo, and no visual meshes"
