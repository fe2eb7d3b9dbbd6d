"""A lock has the interface of a recipe, and a build reports a model whose interface is another one."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.tools.lock import write_lock

MODEL = """\
<mujoco model="m">
  <worldbody>
    <body name="a"><joint name="ja" range="-50 50"/><geom size=".1"/>
      <body name="b"><joint name="jb"/><geom size=".1"/></body></body>
  </worldbody>
  <actuator><motor name="x" joint="ja" ctrlrange="-1 1"/><motor name="y" joint="jb"/></actuator>
  <keyframe><key name="home"/></keyframe>
</mujoco>
"""
RECIPE = "recipe: 1\nbase: ./m.xml\ninterface:\n  joint: [ja, …]\n  actuator: [x, y]\n  key: [home]\n"
RECIPE_PATH = Path("r.yaml")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "m.xml").write_text(MODEL)
    (tmp_path / "r.yaml").write_text(RECIPE)
    return tmp_path


def context(folder: Path, *, locked: bool = False) -> Context:
    return Context(environment={}, folder=folder, fetching=Fetching(locked=locked))


def faults(folder: Path, *, locked: bool = True) -> dict[str, list[str]]:
    """The errors of a build by code, each with its notes."""
    given = context(folder, locked=locked)
    build(ModelRequest(folder / "r.yaml"), given)
    return {each.code: [note.message for note in each.notes] for each in given.sink.errors}


def test_the_lock_has_names_sizes_units_and_ranges(folder: Path) -> None:
    made = write_lock(RECIPE_PATH, None, context(folder))
    assert made is not None and "the interface: locked" in made[1]
    locked = json.loads((folder / "r.lock").read_text())["interface"]
    assert [*locked] == ["joint", "actuator", "key"]
    assert [each["name"] for each in locked["joint"]] == ["ja"]
    assert locked["actuator"][0] == {"name": "x", "unit": "N m", "sizes": [1, 0], "ranges": [[-1.0, 1.0]]}
    assert locked["key"] == [{"name": "home"}]
    assert faults(folder) == {} and faults(folder, locked=False) == {}
    text = (folder / "r.lock").read_bytes()
    assert write_lock(RECIPE_PATH, None, context(folder)) == ("r.lock", []) and (folder / "r.lock").read_bytes() == text


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('ctrlrange="-1 1"', 'ctrlrange="-1 2"', "the actuator `x`: ranges [[-1.0, 1.0]] is now [[-1.0, 2.0]]"),
        (
            '<motor name="y" joint="jb"/>',
            '<position name="y" joint="jb" kp="1"/>',
            "the actuator `y`: unit N m is now rad",
        ),
        ('name="ja" range="-50 50"', 'name="ja" type="slide"', "the joint `ja`: type hinge is now slide"),
    ],
)
def test_a_change_of_the_model_is_reported_until_it_is_accepted(
    folder: Path, before: str, after: str, said: str
) -> None:
    assert write_lock(RECIPE_PATH, None, context(folder)) is not None
    (folder / "m.xml").write_text(MODEL.replace(before, after))
    assert said in faults(folder, locked=False)["interface-changed"]
    own = context(folder)
    assert write_lock(RECIPE_PATH, None, own) is None
    assert [each.code for each in own.sink.errors] == ["interface-changed"]
    assert "--upgrade-interface" in str(own.sink.errors[0].help)
    made = write_lock(RECIPE_PATH, None, context(folder), interface=True)
    assert made is not None and "the interface: changed" in made[1]
    assert faults(folder) == {}


def test_a_change_of_the_list_is_reported(folder: Path) -> None:
    assert write_lock(RECIPE_PATH, None, context(folder)) is not None
    (folder / "r.yaml").write_text(RECIPE.replace("[x, y]", "[y, x]").replace("[home]", "[…]"))
    notes = faults(folder)["interface-changed"]
    assert notes == ["the order of actuators is now `y`, `x`", "the key `home` is no longer listed"]
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    assert "the joint `ja` is no longer listed" in faults(folder)["interface-changed"]
    made = write_lock(RECIPE_PATH, None, context(folder))
    assert made is not None and "the interface: no longer used" in made[1] and faults(folder) == {}


def test_a_lock_without_an_interface_is_valid(folder: Path) -> None:
    (folder / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    assert write_lock(RECIPE_PATH, None, context(folder)) is not None
    assert "interface" not in (folder / "r.lock").read_text()
    (folder / "r.yaml").write_text(RECIPE)
    assert faults(folder) == {}
    made = write_lock(RECIPE_PATH, (), context(folder))
    assert made is not None and "the interface: locked" in made[1]


def test_a_model_that_cannot_be_built_is_not_locked(folder: Path) -> None:
    (folder / "r.yaml").write_text(RECIPE.replace("[x, y]", "[x]"))
    own = context(folder)
    assert write_lock(RECIPE_PATH, None, own) is None
    assert [each.code for each in own.sink.errors] == ["interface-extra"] and not (folder / "r.lock").exists()
