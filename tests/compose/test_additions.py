"""What a recipe adds to a base with rules for a whole model: MuJoCo says what becomes of both."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

BASE = """
<mujoco><compiler SETTING/>
  <worldbody>
    <body name="arm"><joint/><geom size=".1"/><body name="plate"><geom name="plate" size=".1"/></body></body>
  </worldbody>
</mujoco>
"""
ADDED = """
recipe: 1
base: ./base.xml
asset:
  material: {red: {rgba: [1, 0, 0, 1]}}
add:
  - to: world
    body:
      name: tool
      joint: {type: slide}
      geom: {name: tool, size: [0.1], group: 2, material: red, contype: 0, conaffinity: 0}
      body: {name: lens, geom: {name: lens, size: [0.05]}}
"""
SETTINGS = (
    'settotalmass="50"',
    'boundmass="9" boundinertia="1"',
    'fusestatic="true"',
    'discardvisual="true"',
    'inertiafromgeom="true"',
    'inertiagrouprange="0 1"',
)


def _built(folder: Path, setting: str, recipe: str) -> tuple[mujoco.MjModel, mujoco.MjModel]:
    """The base alone, and what the recipe makes of it."""
    base = BASE.replace("SETTING", setting)
    (folder / "base.xml").write_text(base)
    (folder / "recipe.yaml").write_text(recipe)
    context = Context(environment={}, folder=folder)
    done = build(ModelRequest(folder / "recipe.yaml"), context)
    assert done is not None, [each.message for each in context.sink.diagnostics]
    composed = mujoco.MjModel.from_xml_string(done.bundle.files["model.xml"].decode())
    return mujoco.MjModel.from_xml_string(base), composed


@pytest.mark.parametrize("setting", SETTINGS)
def test_the_rules_of_the_base_are_for_the_base(tmp_path: Path, setting: str) -> None:
    alone, composed = _built(tmp_path, setting, ADDED)
    _, plain = _built(tmp_path, "", ADDED)
    assert composed.body("arm").mass[0] == pytest.approx(alone.body("arm").mass[0], rel=1e-12)
    for name in ("tool", "lens"):
        assert composed.body(name).mass[0] == plain.body(name).mass[0]
        assert composed.geom(name).bodyid[0] == composed.body(name).id
    assert composed.nmat == 1


def test_a_compiler_section_is_for_the_whole_model(tmp_path: Path) -> None:
    _, composed = _built(tmp_path, "", f"{ADDED}compiler: {{settotalmass: 5}}\n")
    assert sum(composed.body_mass) == pytest.approx(5)
    _, composed = _built(tmp_path, 'settotalmass="50"', f"{ADDED}compiler: {{settotalmass: 5}}\n")
    assert sum(composed.body_mass) == pytest.approx(5)


def test_a_replicate_turns_in_the_sequence_of_the_recipe(tmp_path: Path) -> None:
    recipe = """
recipe: 1
base: ./base.xml
add:
  - {to: world, replicate: {count: 2, euler: [90deg, 0, 0], body: {name: b, geom: {size: [0.1]}}}}
"""
    _, composed = _built(tmp_path, 'eulerseq="zyx"', recipe)
    assert composed.body("b1").quat == pytest.approx([0.5**0.5, 0.5**0.5, 0, 0])


PART = """
<mujoco>
  <worldbody>
    <geom name="flange" size=".02" density="500"/>
    <body name="hand"><joint/><geom name="palm" size=".03" density="700"/></body>
  </worldbody>
</mujoco>
"""
WITH_PARTS = """
recipe: 1
base: ./base.xml
add:
  - {to: arm, frame: {name: mount, pos: [0, 0, 0.1]}}
  - to: world
    body:
      name: holder
      inertial: {pos: [0, 0, 0], mass: 1, diaginertia: [1, 1, 1]}
      geom: {name: grip, size: [0.02], density: 300}
  - {to: holder, frame: {name: hook, geom: {name: pin, size: [0.01], density: 400}}}
attach:
  left: {model: ./part.xml, frame: mount}
  right: {model: ./part.xml, frame: hook}
"""


@pytest.mark.parametrize("setting", ["", 'boundmass="3"'])
def test_masses_of_the_parts_in_an_added_element_are_not_the_recipes(tmp_path: Path, setting: str) -> None:
    (tmp_path / "base.xml").write_text(BASE.replace("SETTING", setting))
    (tmp_path / "part.xml").write_text(PART)
    (tmp_path / "recipe.yaml").write_text(WITH_PARTS)
    context = Context(environment={}, folder=tmp_path)
    assert build(ModelRequest(tmp_path / "recipe.yaml"), context) is not None
    about_mass = ("without-effect", "compiler-setting")
    why = "has no effect: `holder` has an `<inertial>`, which holds instead of the masses of its geoms"
    assert sorted(each.message for each in context.sink.diagnostics if each.code in about_mass) == [
        f"`density` of geom `grip` {why}",
        f"`density` of geom `pin` {why}",
    ]
