"""Bodies of a page as they are: hidden, alone, several selected, like glass, with their masses, and by part and file."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of

pytestmark = pytest.mark.slow
ARM = """<mujoco>
  <worldbody>
    <body name="upper"><joint name="elbow" axis="0 1 0"/><geom name="rod" type="box" size="0.3 0.1 0.05" mass="2" rgba="1 0 0 1"/>
      <site name="end" pos="0.3 0 0"/>
      <body name="lower" pos="0 0 0.4"><geom name="ball" size="0.1" mass="1"/><geom size="0.02" pos="0 0 0.2" mass="0"/></body>
    </body>
  </worldbody>
</mujoco>
"""
TOOL = """<mujoco><asset><mesh name="tent" vertex="0 0 0.2 0.2 0 0 -0.1 0.1 0 -0.1 -0.1 0 0 0 0.02"/></asset>
<worldbody><body name="tool"><geom name="tent" type="mesh" mesh="tent"/></body></worldbody></mujoco>"""
RECIPE = "recipe: 1\nbase: ./arm.xml\nattach: {tool: {model: ./tool.xml, site: end}}\n"
SHOWN = """() => Object.fromEntries(mjcompose.world.batches.filter(each => each.kind === "geom").flatMap(
    ({ mesh, members }) => members.map((index, at) => [mjcompose.world.model.scene.geom.name[index],
        mesh.instanceMatrix.array[16 * at + 15] * Math.hypot(...mesh.instanceMatrix.array.slice(16 * at, 16 * at + 3)) > 0])))"""
COLOR = """() => Object.fromEntries(mjcompose.world.batches.filter(each => each.kind === "geom").flatMap(
    ({ mesh, members }) => members.map((index, at) => [mjcompose.world.model.scene.geom.name[index],
        Array.from(mesh.instanceColor.array.slice(3 * at, 3 * at + 3)).map(each => Math.round(255 * each))])))"""


@pytest.fixture
def page(tmp_path: Path, open_page: Callable[..., Any]) -> Any:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "tool.xml").write_text(TOOL)
    (tmp_path / "arm.yaml").write_text(RECIPE)
    with Session() as session:
        return open_page(page_of("arm.yaml", tmp_path, session).as_uri())


def select(page: Any, name: str, *more: str) -> None:
    rows = page.locator(".left .row.body")
    for row in page.locator(".left .row.body .toggle").all():
        if row.inner_text() and row.locator("xpath=../..").get_attribute("aria-expanded") == "false":
            row.click()
    rows.filter(has_text=name).first.click()
    for other in more:
        rows.filter(has_text=other).first.click(modifiers=["Shift"])


def test_a_body_is_hidden_or_alone_and_comes_back(page: Any) -> None:
    every = {"rod": True, "ball": True, "": True, "tool/tent": True}
    assert page.evaluate(SHOWN) == every
    select(page, "lower")
    page.keyboard.press("h")
    assert page.evaluate(SHOWN) == {**every, "ball": False, "": False}
    page.get_by_role("tab", name="Show").click()
    assert "2 geoms are hidden" in page.locator(".show:not(.meters)").inner_text()
    middle = page.evaluate("mjcompose.world.box().max.z")
    assert middle < 0.3, "a hidden thing has no room in the picture"
    page.evaluate("mjcompose.show([mjcompose.world.model])")
    page.wait_for_selector("html[data-shown='2']", state="attached")
    assert page.evaluate(SHOWN) == {**every, "ball": False, "": False}, "another build hides it, too"
    page.get_by_role("button", name="Show all").click()
    assert page.evaluate(SHOWN) == every
    select(page, "upper", "tool/tool")
    assert page.locator(".together").inner_text().startswith("2 selected, their bodies have")
    assert page.evaluate("mjcompose.world.marked.length") == 2
    page.keyboard.press("Shift+h")
    assert page.evaluate(SHOWN) == {"rod": True, "ball": False, "": False, "tool/tent": True}
    page.keyboard.press("Shift+h")
    assert page.evaluate(SHOWN) == every


def test_a_click_goes_through_a_hidden_thing_and_shift_selects_one_more(page: Any) -> None:
    page.evaluate("mjcompose.stage.fit(mjcompose.world.boxOf({kind: 'geom', index: 1}))")
    page.evaluate("mjcompose.stage.sharp()")
    box = page.evaluate(
        "(({left, top, width, height}) => [left + width / 2, top + height / 2])(mjcompose.canvas.getBoundingClientRect())"
    )
    page.mouse.click(*box)
    assert page.evaluate("mjcompose.selection") == {"kind": "geom", "index": 1}
    page.keyboard.down("Shift")
    page.mouse.click(*box)
    page.keyboard.up("Shift")
    assert page.evaluate("mjcompose.selected") == [], "a second click takes it out again"
    page.mouse.click(*box)
    page.keyboard.press("h")
    page.mouse.click(*box)
    assert (page.evaluate("mjcompose.selection") or {}).get("index") != 1


def test_glass_wires_and_colors_by_part_and_file_can_be_taken_back(page: Any) -> None:
    own = page.evaluate(COLOR)
    assert own["rod"] == [255, 0, 0]
    page.get_by_role("tab", name="Show").click()
    page.get_by_label("colors").select_option("part")
    colors = page.evaluate(COLOR)
    assert colors["rod"] == colors["ball"] != colors["tool/tent"]
    assert page.locator(".owner").all_inner_texts() == ["no part", "tool/"]
    page.get_by_label("colors").select_option("file")
    assert page.locator(".owner").all_inner_texts() == ["arm.xml", "tool.xml"]
    page.get_by_label("colors").select_option("model")
    assert page.evaluate(COLOR) == own
    paint = "mjcompose.world.batches.map(({ mesh: { material } }) => [material.opacity, material.wireframe])"
    before = page.evaluate(paint)
    page.get_by_label("transparent").check()
    page.get_by_label("wireframe").check()
    assert all(opacity < 0.4 and wires for opacity, wires in page.evaluate(paint)[:3])
    page.get_by_label("transparent").uncheck()
    page.get_by_label("wireframe").uncheck()
    assert page.evaluate(paint) == before


def test_masses_inertias_and_hulls_are_where_they_are(page: Any) -> None:
    page.get_by_role("tab", name="Show").click()
    for mark in ("centers of mass", "inertia ellipsoids", "convex hulls that collide"):
        page.get_by_label(mark).check()
    page.evaluate("mjcompose.setQpos([0.5])")
    page.evaluate("mjcompose.stage.sharp()")
    matrices = "name => { const { group } = mjcompose.visible.extras.shown.get(name); return Array.from(group.children[0].instanceMatrix?.array ?? group.children[0].matrix.elements); }"
    balls = page.evaluate(matrices, "mass")
    assert balls[16 + 12 : 16 + 15] == pytest.approx([0.4 * math.sin(0.5), 0, 0.4 * math.cos(0.5)], abs=1e-6), "lower"
    shapes = page.evaluate(matrices, "ellipsoids")
    axes = [math.hypot(*shapes[4 * k : 4 * k + 3]) for k in range(3)]
    # A box of half sizes a has the inertia of an ellipsoid of half axes a·√(5/3).
    assert sorted(axes) == pytest.approx(
        [0.05 * math.sqrt(5 / 3), 0.1 * math.sqrt(5 / 3), 0.3 * math.sqrt(5 / 3)], rel=1e-5
    )
    count = page.evaluate(
        "mjcompose.visible.extras.shown.get('hulls').group.children[0].geometry.getAttribute('position').count"
    )
    assert count == 12, "the hull of the tent is a tetrahedron: the corner inside is not part of it"
