from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.bundle.bundle import CheckOutcome
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """<mujoco model="arm"><worldbody><body name="base"><geom name="foot" size="0.1"/>
<body name="link"><joint name="j"/><geom name="rod" size="0.1"/></body></body></worldbody></mujoco>"""
INNER = """recipe: 1
base: ./arm.xml
attach:
  room: {prefix: "", model: {attach: {lamp: {model: ./lamp.xml, prefix: ""}}}}
add: [{to: world, body: {name: tray, geom: {name: flat/top, type: box, size: [0.1, 0.1, 0.01]}}}]
edit: [{select: {geom: "flat/*"}, set: {group: 3}}]
check:
  all: {unchanged: {}}
  base: {unchanged: {part: base}}
  room: {unchanged: {part: room}}
  lamp: {unchanged: {part: room/lamp}}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "lamp.xml").write_text(
        '<mujoco><worldbody><body name="bulb"><geom size="1"/></body></worldbody></mujoco>'
    )
    (tmp_path / "inner.yaml").write_text(INNER)
    return tmp_path


@pytest.mark.parametrize("separator", ["/", "_", "__", ":"])
def test_a_recipe_that_joins_no_names_fits_any_separator(folder: Path, separator: str) -> None:
    """Its globs, and the parts that its checks name, mean the same as in a recipe with its own separator."""
    (folder / "outer.yaml").write_text(
        f"recipe: 1\nseparator: '{separator}'\n"
        "attach: {cell: {model: ./inner.yaml}, line: {model: {separator: '/', base: ./inner.yaml}}}\n"
    )
    context = Context(environment={}, folder=folder)
    outcomes: list[CheckOutcome] = []
    built = build(ModelRequest(folder / "outer.yaml"), context, outcomes=outcomes)
    assert built is not None, context.sink.diagnostics
    names = {str(geom.get("name")): geom.get("group") for geom in built.composed.model.root.iter("geom")}
    assert names[f"cell{separator}flat/top"] == names[f"line{separator}flat/top"] == "3"
    compared = [(outcome.name, outcome.values["parts"]) for outcome in outcomes]
    assert compared == [
        (cell + check, parts)
        for cell in (f"cell{separator}", f"line{separator}base/")
        for check, parts in (("all", 2), ("base", 1), ("room", 1), ("lamp", 1))
    ]
