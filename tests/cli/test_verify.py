from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from mjcompose.cli.main import main

MODEL = '<mujoco model="m"><worldbody><body name="b"><geom size=".1"/></body></worldbody></mujoco>'


@pytest.fixture
def runner(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> CliRunner:
    monkeypatch.chdir(tmp_path)
    Path("m.xml").write_text(MODEL)
    Path("r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    runner = CliRunner()
    assert runner.invoke(main, ["build", "r.yaml", "-o", "out/"]).exit_code == 0
    return runner


def test_a_good_bundle(runner: CliRunner) -> None:
    result = runner.invoke(main, ["verify", "out"])
    assert result.exit_code == 0
    assert result.stdout == "out: ok: 2 files, 1 of 1 parts compared with their sources and unchanged\n"


def test_as_json(runner: CliRunner) -> None:
    result = runner.invoke(main, ["verify", "out", "--output-format", "json"])
    told = json.loads(result.stdout)
    assert told["ok"] is True
    assert told["parts"] == [{"part": "base", "unchanged": True}]


def test_a_harmed_one_for_github(runner: CliRunner) -> None:
    Path("out/model.xml").write_text(Path("out/model.xml").read_text() + "<!-- -->")
    result = runner.invoke(main, ["verify", "out", "--output-format", "github"])
    assert result.exit_code == 1
    assert result.stdout.startswith("::error")


def test_without_sources_it_is_a_warning_and_with_a_recipe_an_error(runner: CliRunner) -> None:
    Path("m.xml").unlink()
    assert runner.invoke(main, ["verify", "out"]).exit_code == 0
    assert runner.invoke(main, ["verify", "out", "--recipe", "r.yaml"]).exit_code == 1


def test_no_bundle_is_wrong_usage(runner: CliRunner) -> None:
    assert runner.invoke(main, ["verify"]).exit_code == 2


def test_a_bundle_without_parts(runner: CliRunner) -> None:
    Path("r.yaml").write_text("recipe: 1\nname: empty\n")
    assert runner.invoke(main, ["build", "r.yaml", "-o", "empty.zip"]).exit_code == 0
    assert runner.invoke(main, ["verify", "empty.zip"]).stdout == "empty.zip: ok: 2 files, no parts\n"


def test_what_is_not_there_is_called_as_it_was_written(
    runner: CliRunner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = runner.invoke(main, ["verify", "gone.zip"])
    assert result.exit_code == 2
    assert "error[file-not-found]: the file or folder `gone.zip` does not exist\n" in result.stderr
