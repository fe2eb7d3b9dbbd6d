from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.pipeline.cache.cells import cells_of
from mjcompose.plan import read
from mjcompose.plan.planner import plan_what_remains
from mjcompose.sources.context import Context

CELL = """\
recipe: 1
params: {load: 1.0}
attach:
  a: {model: ./inner.yaml}
  b: {model: ./inner.yaml}
  c: {model: ./inner.yaml, with: {size: 2}}
add:
  - {geom: {type: sphere, size: ["${load}"]}}
randomize: {seed: 1, samples: 2, fields: {}}
matrix:
  axes: {load: [1.0, 2.0]}
"""


def test_a_recipe_is_expanded_once_for_the_same_values(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "robot.xml").write_text("<mujoco/>")
    (tmp_path / "inner.yaml").write_text("recipe: 1\nparams: {size: 1}\nbase: ./robot.xml\n")
    (tmp_path / "cell.yaml").write_text(CELL)
    expand = read.expand
    validate = read.validate_what_remains
    expanded: list[str] = []
    validated: list[str] = []
    monkeypatch.setattr(read, "expand", lambda node, *rest: expanded.append(node.span.file) or expand(node, *rest))
    monkeypatch.setattr(
        read, "validate_what_remains", lambda node, *rest: validated.append(node.span.file) or validate(node, *rest)
    )
    context = Context(environment={}, folder=tmp_path)
    cells = cells_of(Path("cell.yaml"), context, {})
    assert len(cells) == 6  # two cells with three samples each
    for cell in cells:
        assert plan_what_remains(Path("cell.yaml"), context, cell.given, name=cell.name, sample=cell.sample) is not None
    assert sorted(expanded) == sorted(validated) == ["cell.yaml"] * 2 + ["inner.yaml"] * 2


def test_what_is_wrong_is_found_each_time_in_its_own_sink(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text('recipe: 1\noption: {timestep: "${x}"}\nnobody: 1\n')
    context = Context(environment={}, folder=tmp_path)
    read.validated_recipe(tmp_path / "cell.yaml", {}, context)
    again = Context(environment={}, folder=tmp_path, recipes=context.recipes, concrete=context.concrete)
    read.validated_recipe(tmp_path / "cell.yaml", {}, again)
    assert context.sink.diagnostics == again.sink.diagnostics
    assert {each.code for each in again.sink.errors} == {"unknown-name", "unknown-key"}
