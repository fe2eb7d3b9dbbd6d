from __future__ import annotations

import sys
from pathlib import Path

import pytest
from cli.shell import run, snapshot


def test_the_starter_builds_and_checks(folder: Path) -> None:
    result = run("new", "mine.yaml")
    assert result.exit_code == 0
    assert result.stdout == "wrote mine.yaml; build it with: mjcompose build mine.yaml\n"
    assert run("check", "mine.yaml").stdout == "mine.yaml: ok\n"
    built = run("build", "mine.yaml")
    assert built.exit_code == 0 and (folder / "build" / "mine.zip").exists()
    assert "nq 1, nv 1, nu 1" in built.stdout


def test_default_name(folder: Path) -> None:
    assert run("new").exit_code == 0
    assert (folder / "model.yaml").read_text(encoding="utf-8").count("name: model\n") == 1


@pytest.mark.parametrize("stem", ["01", "a: b", "#1", "true", "x - y", "é", '"', "1e3", "null", "{x}", "my-arm_2"])
def test_any_name(folder: Path, stem: str) -> None:
    assert run("new", f"{stem}.yaml").exit_code == 0
    result = run("plan", f"{stem}.yaml")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith(f"{stem}: the model of {stem}.yaml\n")


def test_nothing_is_overwritten(folder: Path) -> None:
    before = snapshot(folder)
    result = run("new", "cell.yaml")
    assert result.exit_code == 1 and "exists already" in result.stderr
    assert snapshot(folder) == before


def test_it_must_be_a_recipe(folder: Path) -> None:
    result = run("new", "mine.xml")
    assert result.exit_code == 2 and "mine.yaml" in result.stderr


def test_what_cannot_be_written(folder: Path) -> None:
    before = snapshot(folder)
    result = run("new", "cell.yaml/mine.yaml")
    assert result.exit_code == 1 and "error[output-unwritable]" in result.stderr
    assert snapshot(folder) == before


def test_folders_on_the_way_are_made(folder: Path) -> None:
    assert run("new", "a/b/mine.yaml").exit_code == 0
    assert run("check", "a/b/mine.yaml", "--no-compile").exit_code == 0


@pytest.mark.parametrize(("name", "meant"), [("/", "/model.yaml"), ("", "model.yaml"), (".", "model.yaml")])
def test_what_is_no_name(folder: Path, name: str, meant: str) -> None:
    result = run("new", name)
    assert result.exit_code == 2
    assert f"Error: a recipe's name ends in .yaml: {meant}\n" in result.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege there")
def test_a_link_that_leads_to_itself(folder: Path) -> None:
    (folder / "loop").mkdir()
    (folder / "loop" / "x").symlink_to("x")
    for words in (("new", "loop/x", "--project"), ("new", "loop/x/a.yaml")):
        result = run(*words)
        assert result.exit_code in (1, 2), (words, result.stderr)
        assert "error[output-unwritable]" in result.stderr or "Error: " in result.stderr


def test_the_examples_build_without_warnings_outside_the_repository(folder: Path) -> None:
    result = run("new", "--examples", "given")
    assert result.exit_code == 0 and result.stdout.startswith("wrote ")
    built = run("build", "given/demo.yaml", "-o", "demo.zip")
    assert built.exit_code == 0 and built.stderr == ""
    for recipe in (folder / "given").rglob("*.yaml"):
        first = recipe.read_text(encoding="utf-8").partition("\n")[0]
        assert "$schema" not in first or (recipe.parent / first.partition("$schema=")[2]).is_file(), recipe


def test_examples_that_were_changed_are_kept(folder: Path) -> None:
    assert run("new", "--examples").exit_code == 0
    assert run("new", "--examples").stdout.startswith("wrote 0 files to recipes")
    (folder / "recipes" / "demo.yaml").write_text("recipe: 1\n", encoding="utf-8")
    (folder / "recipes" / "cell.yaml").unlink()
    again = run("new", "--examples")
    assert again.stdout.splitlines()[0] == "kept recipes/demo.yaml"
    assert "wrote 1 file to recipes" in again.stdout
    assert (folder / "recipes" / "demo.yaml").read_text(encoding="utf-8") == "recipe: 1\n"


def test_examples_and_a_project_exclude_each_other(folder: Path) -> None:
    result = run("new", "--examples", "--project")
    assert result.exit_code == 2 and "exclude each other" in result.stderr


def test_a_recipe_whose_file_name_has_a_line_break_has_a_name_on_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run("new", "arm\n::error::x.yaml")
    assert result.exit_code == 0 and len(result.stdout.splitlines()) == 1
    assert '"arm_::error::x"' in (tmp_path / "arm\n::error::x.yaml").read_text()
    assert run("check", "arm\n::error::x.yaml").exit_code == 0
