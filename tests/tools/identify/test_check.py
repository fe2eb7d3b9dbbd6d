"""The check `tracks`: a model that moves as the robot passes, another one does not."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.bundle.bundle import CheckOutcome
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from tools.identify import robots

CHECK = "check: {{robot: {{tracks: {{recording: {name}, within: {{qpos: {bound}}}}}}}}}\n"
ALONE = "recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\n"
IN_A_CELL = "recipe: 1\nallow: [license-missing]\nattach: {left: {model: ./robot.yaml, pos: [0, 0, 1]}, right: {model: ./arm.xml}}\n"


def checked(
    folder: Path, bound: str, name: str = "run.csv", nested: bool = False, **model: float
) -> tuple[Context, list[CheckOutcome]]:
    (folder / "arm.xml").write_text(robots.MODEL.format(**{**robots.RECIPE, **model}))
    recipe = ALONE + CHECK.format(name=name, bound=bound)
    (folder / "robot.yaml").write_text(recipe)
    (folder / "recipe.yaml").write_text(IN_A_CELL if nested else recipe)
    context = Context(folder=folder)
    outcomes: list[CheckOutcome] = []
    build(ModelRequest(folder / "recipe.yaml"), context, outcomes=outcomes)
    return context, outcomes


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    robots.write_csv(tmp_path / "run.csv", robots.recorded(robots.model(), 1.0))
    return tmp_path


@pytest.mark.parametrize("nested", [False, True])
def test_the_same_model_follows_the_recording(nested: bool, folder: Path) -> None:
    context, outcomes = checked(folder, "0.3mrad", nested=nested)
    assert context.sink.errors == []
    errors = outcomes[0].values
    assert len(errors) == 2
    assert max(errors.values()) < 3e-4


def test_another_model_does_not(folder: Path) -> None:
    context, _ = checked(folder, "0.3mrad", damping=0.9)
    assert {error.code for error in context.sink.errors} == {"check-failed"}
    assert any("`qpos elbow` has a root mean square error of" in error.message for error in context.sink.errors)
    assert checked(folder, "50mrad", damping=0.9)[0].sink.errors == []


@pytest.mark.parametrize(
    ("name", "code"), [("none.csv", "file-not-found"), ("run.bag", "recording-kind"), ("bad.csv", "recording-column")]
)
def test_a_recording_that_cannot_be_read(name: str, code: str, folder: Path) -> None:
    (folder / "run.bag").write_text("")
    (folder / "bad.csv").write_text("time,elbow\n0,1\n0.1,2\n")
    context, _ = checked(folder, "0.3mrad", name)
    (error,) = context.sink.errors
    assert (error.code, error.span.file, error.span.line) == (code, "recipe.yaml", 4)


def test_the_recording_counts_as_an_input(folder: Path) -> None:
    from mjcompose.pipeline.cache.inputs import Inputs

    (folder / "arm.xml").write_text(robots.MODEL.format(**robots.RECIPE))
    (folder / "recipe.yaml").write_text(ALONE + CHECK.format(name="run.csv", bound="1rad"))
    context = Context(folder=folder)
    built = build(ModelRequest(folder / "recipe.yaml"), context)
    assert built is not None
    assert str(folder / "run.csv") in Inputs().others(built, context)


def test_a_data_set_as_the_recording(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    robots.write_lerobot(tmp_path / "set", robots.recorded(robots.model(), 1.0))
    context, _ = checked(tmp_path, "0.5mrad", name="set")
    assert [error.message for error in context.sink.errors] == ["check `robot`: `set`: it has several episodes: 0 to 1"]


NUMBERS = "measured: 1\nvalues: {{joint elbow: {{damping: {{value: {damping}}}}}}}\n"
COMPARED = "check: {robot: {tracks: {recording: run.csv, within: {qpos: 1rad}, worse_than_recipe: error}}}\n"


@pytest.mark.parametrize("nested", [False, True])
@pytest.mark.parametrize(("damping", "is_worse"), [(0.5, False), (0.9, False), (1.6, True)])
def test_a_model_that_is_worse_than_the_recipe_without_measured_numbers(
    damping: float, is_worse: bool, nested: bool, tmp_path: Path
) -> None:
    robots.write_csv(tmp_path / "run.csv", robots.recorded(robots.model(damping=0.9), 1.0))
    (tmp_path / "arm.xml").write_text(robots.MODEL.format(**robots.RECIPE))  # with a damping of 0.5
    (tmp_path / "A12.yaml").write_text(NUMBERS.format(damping=damping))
    (tmp_path / "robot.yaml").write_text(ALONE + "measured: A12.yaml\n" + COMPARED)
    recipe = tmp_path / "robot.yaml"
    if nested:
        recipe = tmp_path / "cell.yaml"
        recipe.write_text(IN_A_CELL)
    context = Context(folder=tmp_path)
    build(ModelRequest(recipe), context)
    found = [(error.code, error.span.file, error.span.line) for error in context.sink.errors if error.span]
    assert found == ([("worse-than-recipe", "robot.yaml", 5)] if is_worse else [])


def test_nothing_to_compare_with(folder: Path) -> None:
    (folder / "arm.xml").write_text(robots.MODEL.format(**robots.RECIPE))
    (folder / "recipe.yaml").write_text(ALONE + COMPARED)
    context = Context(folder=folder)
    build(ModelRequest(folder / "recipe.yaml"), context)
    (error,) = context.sink.errors
    assert error.code == "missing-key"
    assert "has no `measured`" in error.message
