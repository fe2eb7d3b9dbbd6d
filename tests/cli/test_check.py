from __future__ import annotations

from pathlib import Path

from cli.shell import run, snapshot


def test_a_right_recipe(folder: Path) -> None:
    before = snapshot(folder)
    result = run("check", "cell.yaml")
    assert result.exit_code == 0
    assert result.stdout == "cell.yaml: ok\n" and result.stderr == ""
    assert snapshot(folder) == before


def test_several_recipes(folder: Path) -> None:
    result = run("check", "wrong.yaml", "cell.yaml", "nowhere.yaml", "--no-verify")
    assert result.exit_code == 1
    assert result.stdout == "cell.yaml: ok\n"
    assert "error[attach-place]" in result.stderr and "error[file-not-found]" in result.stderr


def test_mujoco_is_asked(folder: Path) -> None:
    assert run("check", "rejected.yaml").exit_code == 1
    assert run("check", "rejected.yaml", "--no-verify").exit_code == 0


def test_json_of_a_right_recipe_is_empty(folder: Path) -> None:
    result = run("check", "cell.yaml", "--no-verify", "--json")
    assert result.exit_code == 0 and result.stdout == "" and result.stderr == ""


def test_usage() -> None:
    assert run("check").exit_code == 2
