"""`mjcompose build --all` and `--pick` of a recipe that draws."""

from __future__ import annotations

import csv
import hashlib
import importlib.util
import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mjcompose.cli.main import main

MODEL = '<mujoco><worldbody><body name="b"><freejoint/><geom name="g" size="0.1"/></body></worldbody></mujoco>'
DRAWS = """\
randomize:
  seed: 7
  samples: 3
  fields:
    friction: {select: {geom: g}, attr: friction, uniform: [0.5, 1]}
    size: {param: size, scale: {uniform: [0.5, 2]}}
"""
OF_ATTRIBUTES = DRAWS.replace("    size: {param: size, scale: {uniform: [0.5, 2]}}\n", "")
HEAD = "recipe: 1\nname: ball\nbase: ./model.xml\nparams: {size: 1}\n"
MATRIX = "matrix: {axes: {size: [1, 2]}}\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.xml").write_text(MODEL)
    (tmp_path / "r.yaml").write_text(HEAD + DRAWS)
    return tmp_path


def run(*words: str) -> Result:
    return CliRunner().invoke(main, words, prog_name="mjcompose")


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def digests(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.glob("*.zip"))}


def test_all_samples_and_their_table(folder: Path) -> None:
    result = run("build", "r.yaml", "--all")
    assert result.exit_code == 0, result.output
    assert "wrote build/samples.csv: the draws of 4 models" in result.stdout
    assert list(digests(folder / "build")) == [f"ball-s000{n}.zip" for n in range(4)]
    rows = table(folder / "build" / "samples.csv")
    assert list(rows[0]) == ["model", "sample", "size", "friction[g][0]", "friction[g][1]", "friction[g][2]"]
    assert rows[0] == dict.fromkeys(rows[0], "") | {"model": "ball-s0000", "sample": "0"}
    assert [row["model"] for row in rows] == [f"ball-s000{n}" for n in range(4)]
    assert run("build", "r.yaml", "--pick", "ball-s0002", "-o", "one/").exit_code == 0
    manifest = json.loads((folder / "one" / "manifest.json").read_text())
    assert (manifest["name"], manifest["sample"], manifest["seed"]) == ("ball-s0002", 2, 7)
    size, friction = manifest["draws"]
    assert float(rows[2]["size"]) == size["value"]
    assert [float(rows[2][f"friction[g][{n}]"]) for n in range(3)] == friction["value"]


def test_one_alone_is_what_it_is_among_all(folder: Path) -> None:
    assert run("build", "r.yaml", "--all", "-o", "all/{name}.zip").exit_code == 0
    assert run("build", "r.yaml", "--pick", "ball-s0003", "--pick", "ball-s0001", "-o", "two/{name}.zip").exit_code == 0
    every = digests(folder / "all")
    two = digests(folder / "two")
    assert two.items() < every.items()
    assert not (folder / "two" / "samples.csv").exists()


def test_cells_share_their_draws(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + MATRIX + DRAWS)
    assert run("build", "r.yaml", "--all", "--no-compile").exit_code == 0
    rows = {row.pop("model"): row for row in table(folder / "build" / "samples.csv")}
    assert len(rows) == 8
    assert rows["ball-1-s0002"] == rows["ball-2-s0002"] != rows["ball-1-s0001"]


def test_where_the_table_goes(folder: Path) -> None:
    assert run("build", "r.yaml", "--pick", "ball-s0001", "-o", "one/", "--sample-table", "t/one.csv").exit_code == 0
    assert [row["sample"] for row in table(folder / "t" / "one.csv")] == ["1"]


def test_parquet(folder: Path) -> None:
    result = run("build", "r.yaml", "--all", "--no-compile", "--sample-table", "t.parquet")
    if importlib.util.find_spec("pyarrow") is None:
        assert result.exit_code == 1 and "needs the package `pyarrow`" in result.stderr
        assert not (folder / "t.parquet").exists()
        return
    from pyarrow import parquet

    found = parquet.read_table(folder / "t.parquet").to_pydict()
    assert found["sample"] == [0, 1, 2, 3]
    assert found["size"][0] is None and 0.5 < found["size"][1] < 2


def test_a_cell_that_a_draw_would_replace(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + MATRIX + DRAWS.replace("scale: {uniform: [0.5, 2]}", "uniform: [0.5, 2]"))
    result = run("build", "r.yaml", "--all")
    assert result.exit_code == 1
    assert "r.yaml:11:19: error[unknown-name]: `size` is an axis of the matrix" in result.stderr


def test_a_recipe_that_is_one_model(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD)
    assert run("build", "r.yaml", "--all", "-o", "{name}/").exit_code == 0
    assert not (folder / "samples.csv").exists()
    result = run("build", "r.yaml", "--pick", "ball-s0001")
    assert result.exit_code != 0 and "has neither `matrix` nor `randomize`" in result.stderr


def test_the_nominal_model_has_no_draws(folder: Path) -> None:
    assert run("build", "r.yaml", "-o", "one/").exit_code == 0
    manifest = json.loads((folder / "one" / "manifest.json").read_text())
    assert (manifest["name"], manifest["sample"], manifest["draws"]) == ("ball", 0, [])


def test_a_sample_stays_its_parts_but_for_its_draws(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + DRAWS + "check: {whole: {unchanged: {}}}\n")
    assert run("build", "r.yaml", "--pick", "ball-s0001", "-o", "one/").exit_code == 0
    result = run("verify", "one/")
    assert result.exit_code == 0 and "unchanged" in result.stdout


def test_the_plan_tells_the_samples(folder: Path) -> None:
    text = run("plan", "r.yaml").stdout
    assert "draw friction: friction of {geom: g} = uniform 0.5 to 1\n" in text
    assert "4 models, built by --all or --pick:\n  ball-s0000 … ball-s0003, ball-s0000 without a draw\n" in text
    data = json.loads(run("plan", "r.yaml", "--output-format", "json").stdout)
    assert data["randomize"]["samples"] == 3
    assert [cell["sample"] for cell in data["cells"]] == [0, 1, 2, 3]


def test_check_looks_at_every_sample(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + DRAWS.replace("uniform: [0.5, 1]", "normal: {mean: 0.1, std: 0.1}"))
    result = run("check", "r.yaml")
    assert result.exit_code == 1
    assert "of field `friction` gives geom `g` the friction -" in result.stderr


def test_worlds_are_one_model(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + OF_ATTRIBUTES)
    assert run("build", "r.yaml", "--as", "worlds", "--all", "-o", "{name}/").exit_code == 0
    assert len(table(folder / "ball" / "samples.csv")) == 4
    assert not (folder / "samples.csv").exists() and (folder / "ball" / "worlds.npz").exists()
    assert run("build", "r.yaml", "-o", "ball/").exit_code == 0  # the cache has both
    assert not (folder / "ball" / "worlds.npz").exists()
    result = run("build", "r.yaml", "--as", "worlds", "-o", "ball.xml")
    assert result.exit_code == 1 and "`ball.xml` cannot store the worlds" in result.stderr
    result = run("build", "r.yaml", "--as", "worlds", "-o", "other/", "--no-compile")
    assert result.exit_code == 1 and "the model that MuJoCo compiles" in result.stderr


def test_a_second_run_builds_nothing_and_has_the_same_table(folder: Path) -> None:
    assert run("build", "r.yaml", "--all").exit_code == 0
    first = (folder / "build" / "samples.csv").read_bytes()
    (folder / "build" / "samples.csv").unlink()
    again = run("build", "r.yaml", "--all", "--why")
    assert again.exit_code == 0 and again.stdout.count("is up to date") == 4, again.output
    assert (folder / "build" / "samples.csv").read_bytes() == first


def test_known_worlds_are_not_lost_in_a_form_without_room(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + OF_ATTRIBUTES)
    assert run("build", "r.yaml", "--as", "worlds").exit_code == 0
    refused = run("build", "r.yaml", "--as", "worlds", "-o", "ball.mjb")
    assert refused.exit_code == 1 and "cannot store the worlds" in refused.stderr
    assert not list(folder.glob("*.mjb"))


def test_the_name_of_a_cell_means_all_its_samples(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + MATRIX + DRAWS)
    told = run("plan", "r.yaml", "--output-format", "json").stdout
    cells = sorted({each["name"].rpartition("-s")[0] for each in json.loads(told)["cells"]})
    assert len(cells) == 2
    result = run("build", "r.yaml", "--pick", cells[0], "-o", "one/{name}.zip")
    assert result.exit_code == 0, result.output
    assert list(digests(folder / "one")) == [f"{cells[0]}-s000{n}.zip" for n in range(4)]
    alone = run("build", "r.yaml", "--pick", cells[0], "-o", "one.zip")
    assert alone.exit_code == 2 and "error[output-kind]" in alone.stderr and not (folder / "one.zip").exists()


def test_faults_name_the_cell_and_the_sample(folder: Path) -> None:
    check = "check: {light: {expect: {attr: mass, range: [0, 1]}}}\n"
    (folder / "r.yaml").write_text(HEAD + MATRIX + DRAWS + check)
    for form in ("build", "check"):
        lines = run(form, "r.yaml", "--pick", "ball-2", "--sample", "1", "--output-format", "json").stdout.splitlines()
        fault, summary = map(json.loads, lines)
        cell = {"name": "ball-2-s0001", "cell": "ball-2", "sample": 1}
        assert fault["code"] == "check-failed" and fault["cells"] == [cell]
        assert summary == {"recipe": "r.yaml", "cells": 1, "failed": [cell]}


def test_one_sample_of_all_cells(folder: Path) -> None:
    (folder / "r.yaml").write_text(HEAD + MATRIX + DRAWS)
    result = run("build", "r.yaml", "--sample", "2", "--no-compile", "-o", "x/{name}.zip")
    assert result.exit_code == 0, result.output
    assert list(digests(folder / "x")) == ["ball-1-s0002.zip", "ball-2-s0002.zip"]
    gone = run("build", "r.yaml", "--sample", "9")
    assert gone.exit_code == 2 and "sample 9 does not exist: the recipe has the samples 0 to 3" in gone.stderr
    (folder / "one.yaml").write_text(HEAD)
    assert run("check", "one.yaml", "--sample", "1").exit_code == 2


def test_one_model_needs_no_name_in_its_output(folder: Path) -> None:
    (folder / "one.yaml").write_text(HEAD)
    result = run("build", "one.yaml", "--all", "--no-compile", "-o", "x/")
    assert result.exit_code == 0 and (folder / "x" / "model.xml").is_file(), result.output
    several = run("build", "r.yaml", "--all", "--no-compile", "-o", "y/")
    assert several.exit_code == 2 and "several models cannot all be `y/`" in several.stderr


@pytest.mark.parametrize("given", ["3", "drawn", "drawn.txt"])
def test_a_table_of_samples_that_is_none(folder: Path, given: str) -> None:
    result = run("build", "r.yaml", "--sample-table", given)
    assert result.exit_code == 2 and f"`{given}`: `--sample NUMBER` builds one" in result.stderr
    assert not (folder / "build").exists()


def test_the_last_line_counts_the_models(folder: Path) -> None:
    assert run("build", "r.yaml", "--all").stdout.endswith("r.yaml: 4 models built\n")
    again = run("build", "r.yaml", "--all").stdout.splitlines()[-1]
    assert again in ("r.yaml: 4 models built, 4 from the cache", "r.yaml: 4 models built")
    assert "models built" not in run("build", "r.yaml", "--all", "-q").stdout
    assert "models built" not in run("build", "r.yaml", "--all", "--output-format", "json").stdout
