"""A file of measurements becomes entries of `edit`, with its own places."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context

ARM = """<mujoco model="arm"><worldbody><body name="a"><joint name="pan"/><geom size=".1"/>
  <body name="b" pos="0 0 .3"><joint name="el{bow}" damping="1"/><geom size=".1"/></body></body></worldbody></mujoco>"""
FILE = """measured: 1
values:
  joint left/pan: {damping: {value: 0.7, std: 0.1}, armature: {value: 0.01}}
  joint left/el{bow}:
    damping: {value: 0.25, std: 0.05}
    frictionloss: {value: 9, std: 5, not_identified: only together with damping}
  body left/b: {mass: {value: 2.5, std: 0.1}}
"""
RECIPE = "recipe: 1\nallow: [license-missing]\nattach: {{arm: {{model: ./arm.xml}}}}\n{}\n"
USE = 'measured: {file: A12.yaml, rename: {"left/**": "arm/**"}%s}'


def built(section: str, folder: Path) -> tuple[Built | None, Context]:
    (folder / "arm.xml").write_text(ARM)
    (folder / "A12.yaml").write_text(FILE)
    (folder / "recipe.yaml").write_text(RECIPE.format(section))
    context = Context(folder=folder)
    return build(ModelRequest(folder / "recipe.yaml"), context), context


def model(section: str, folder: Path) -> str:
    made, context = built(section, folder)
    assert made is not None, context.sink.diagnostics
    return made.bundle.files[made.bundle.model].decode()


def test_it_is_the_same_as_edits(tmp_path: Path) -> None:
    edits = """edit:
- {select: {joint: arm/pan}, set: {damping: 0.7, armature: 0.01}}
- {select: {joint: "**", where: "${name == 'arm/el{bow}'}"}, set: {damping: 0.25}}
- {select: {body: arm/b}, set: {mass: 2.5}}"""
    assert model(USE % "", tmp_path) == model(edits, tmp_path)


def test_numbers_that_are_not_identified_are_applied_on_request(tmp_path: Path) -> None:
    assert 'frictionloss="9"' not in model(USE % "", tmp_path)
    assert 'frictionloss="9"' in model(USE % ", unknown: use", tmp_path)


def test_only_some_elements(tmp_path: Path) -> None:
    text = model(USE % ', only: {joint: "arm/p*"}', tmp_path)
    assert 'damping="0.7"' in text
    assert 'mass="2.5"' not in text
    assert 'damping="0.25"' not in text


def test_only_some_elements_of_one_number(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "A12.yaml").write_text("measured: 1\nvalues: {joint pan: {damping: {value: 7, also: ['el{bow}']}}}\n")
    recipe = "recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\nmeasured: {file: A12.yaml, only: {joint: pan}}\n"
    (tmp_path / "recipe.yaml").write_text(recipe)
    made = build(ModelRequest(tmp_path / "recipe.yaml"), Context(folder=tmp_path))
    assert made is not None
    text = made.bundle.files[made.bundle.model].decode()
    assert text.count('damping="7"') == 1
    assert 'name="el{bow}" damping="1"' in text


def test_a_number_leaves_the_other_numbers_of_its_attribute(tmp_path: Path) -> None:
    arm = ARM.replace('damping="1"', 'damping="1 0.2 0.3"').replace(
        '<joint name="pan"/>', '<joint name="pan" range="0 1"/>'
    )
    (tmp_path / "arm.xml").write_text(
        arm.replace('<geom size=".1"/>', '<geom name="g" size=".1" friction=".5 .02 .03"/>', 1)
    )
    file = 'measured: 1\nvalues:\n  geom g: {friction: {value: 0.7}}\n  "joint el{bow}": {damping: {value: 4}}\n'
    (tmp_path / "A12.yaml").write_text(file)
    (tmp_path / "recipe.yaml").write_text("recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\nmeasured: A12.yaml\n")
    made = build(ModelRequest(tmp_path / "recipe.yaml"), Context(folder=tmp_path))
    assert made is not None
    text = made.bundle.files[made.bundle.model].decode()
    assert 'friction="0.7 0.02 0.03"' in text
    assert 'damping="4 0.2 0.3"' in text


def test_a_number_follows_the_edits_of_the_recipe_and_names_its_line(tmp_path: Path) -> None:
    section = 'edit: [{select: {joint: "arm/**"}, set: {damping: 5}}]\n' + USE % ""
    made, _ = built(section, tmp_path)
    assert made is not None
    assert 'damping="5"' not in made.bundle.files[made.bundle.model].decode()
    places = [(step.span.file, step.span.line) for step in made.plan.edits]
    assert places == [("recipe.yaml", 4), *(("A12.yaml", line) for line in (3, 3, 5, 7))]


def test_the_file_counts_as_an_input(tmp_path: Path) -> None:
    from mjcompose.pipeline.cache.inputs import Inputs

    made, context = built(USE % "", tmp_path)
    assert made is not None
    assert str(tmp_path / "A12.yaml") in Inputs().others(made, context)


@pytest.mark.parametrize("name", ["../A12.yaml", "/etc/passwd"])
def test_a_nested_recipe_of_a_stranger_reads_no_other_file(name: str, tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "A12.yaml").write_text(FILE)
    (inner / "arm.xml").write_text(ARM)
    (inner / "scene.xml").write_text(
        '<mujoco><asset><model name="m" file="robot.yaml"/></asset><worldbody><attach model="m" prefix="x"/></worldbody></mujoco>'
    )
    (inner / "robot.yaml").write_text(f"recipe: 1\nbase: ./arm.xml\nmeasured: {name}\n")
    (tmp_path / "recipe.yaml").write_text("recipe: 1\nattach: {arm: {model: ./inner/scene.xml}}\n")
    context = Context(folder=tmp_path)
    assert build(ModelRequest(tmp_path / "recipe.yaml"), context) is None
    assert "source-outside" in {each.code for each in context.sink.errors}


@pytest.mark.parametrize(
    ("number", "is_refused"),
    [
        ("joint pan: {damping: {value: -0.5}}", True),
        ("joint pan: {frictionloss: {value: -1e-9}}", True),
        ("joint pan: {ref: {value: -1deg}}", False),
        ("joint pan: {zero: {value: -1deg}}", False),
        ("body a: {mass: {value: -2}}", True),
    ],
)
def test_a_number_that_cannot_be_negative(number: str, is_refused: bool, tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM)
    (tmp_path / "A12.yaml").write_text(f"measured: 1\nvalues:\n  {number}\n")
    recipe = "recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\nmeasured: A12.yaml\n"
    (tmp_path / "recipe.yaml").write_text(recipe)
    context = Context(folder=tmp_path)
    build(ModelRequest(tmp_path / "recipe.yaml"), context)
    found = [(error.code, error.span.file, error.span.line) for error in context.sink.errors if error.span]
    assert found == ([("out-of-range", "A12.yaml", 3)] if is_refused else [])
