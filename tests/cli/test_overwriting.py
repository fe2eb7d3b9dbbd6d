"""No output takes the place of a file that the model is made from."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from cli.shell import run

TEXTURE = Path(__file__).parents[2] / "recipes" / "models" / "table" / "textures" / "wood.png"
MODEL = """<mujoco>
  <include file="light.xml"/>
  <asset><texture name="wood" type="2d" file="wood.png"/><material name="wood" texture="wood"/></asset>
  <worldbody><geom name="box" type="box" size=".1 .1 .1" material="wood"/></worldbody>
</mujoco>
"""
LIGHT = '<mujoco><worldbody><light pos="0 0 3"/></worldbody></mujoco>'
RECIPE = """recipe: 1
name: wood
base: ./table.xml
params: {size: 1}
matrix: {axes: {size: [1, 2]}}
edit: [{select: {geom: box}, scale: {size: "${size}"}}]
"""


@pytest.fixture
def table(folder: Path) -> Path:
    """A recipe with the name of its texture, whose model includes a file."""
    for name, text in (("table.xml", MODEL), ("light.xml", LIGHT), ("table.yaml", RECIPE)):
        (folder / name).write_text(text)
    shutil.copy(TEXTURE, folder / "wood.png")
    return folder


@pytest.mark.parametrize(
    ("arguments", "source"),
    [
        (("build", "table.yaml", "-o", "light.xml"), "light.xml"),
        (("build", "table.yaml", "-o", "wood.xml", "--picture"), "wood.png"),
        (("render", "table.yaml", "-o", "wood.png"), "wood.png"),
        (("render", "table.yaml", "--all", "--jobs", "1", "-o", "wood.png"), "wood.png"),
        (("render", "table.xml", "-o", "wood.png"), "wood.png"),
        (("view", "table.yaml", "--html", "light.xml"), "light.xml"),
        (("view", "table.xml", "--html", "table.xml"), "table.xml"),
    ],
    ids=lambda given: " ".join(given) if isinstance(given, tuple) else "",
)
def test_no_output_takes_the_place_of_a_source(table: Path, arguments: tuple[str, ...], source: str) -> None:
    before = {path.name: path.read_bytes() for path in table.iterdir() if path.is_file()}
    result = run(*arguments)
    if "error[no-rendering]" in result.stderr:
        pytest.skip("there is no OpenGL")
    assert result.exit_code == 1, result.output
    assert f"{source}` is one of the files that this model is built from" in result.stderr
    assert {path.name: path.read_bytes() for path in table.iterdir() if path.is_file()} == before
