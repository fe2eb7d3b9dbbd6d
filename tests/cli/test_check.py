from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as Xml

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


CHECKED = """
check:
  dims: {size: {nq: 1}}
  have: {exists: [{site: flange}]}
"""


def test_checks_are_counted_and_one_that_fails_is_told(folder: Path) -> None:
    recipe = folder / "cell.yaml"
    recipe.write_text(recipe.read_text() + CHECKED)
    assert run("check", "cell.yaml").stdout == "cell.yaml: ok, 2 checks hold\n"
    recipe.write_text(recipe.read_text().replace("nq: 1", "nq: 2"))
    result = run("check", "cell.yaml")
    assert result.exit_code == 1
    assert "error[check-failed]: check `dims`: `nq` is 1, not 2" in result.stderr
    annotated = run("check", "cell.yaml", "--format", "github").stdout
    assert annotated.startswith("::error file=cell.yaml,line=10,col=21,")
    assert run("check", "cell.yaml", "--no-verify").exit_code == 0


def cases(text: str) -> dict[str, str | None]:
    """By suite and case, the type of its failure."""
    found: dict[str, str | None] = {}
    for suite in Xml.fromstring(text):
        for case in suite:
            failure = case.find("failure")
            found[f"{suite.get('name')} {case.get('name')}"] = (
                None if failure is None else failure.get("type")
            )
    return found


def test_junit(folder: Path) -> None:
    recipe = folder / "cell.yaml"
    recipe.write_text(recipe.read_text() + CHECKED.replace("flange", "flang"))
    result = run("check", "cell.yaml", "wrong.yaml", "--junit", "out/report.xml")
    assert result.exit_code == 1
    assert cases((folder / "out" / "report.xml").read_text(encoding="utf-8")) == {
        "cell.yaml model": None,
        "cell.yaml dims": None,
        "cell.yaml have": "check-failed",
        "wrong.yaml model": "attach-place",
    }


def test_junit_on_standard_output(folder: Path) -> None:
    result = run("check", "cell.yaml", "--junit", "-")
    assert result.exit_code == 0
    assert cases(result.stdout) == {"cell.yaml model": None}


def test_junit_that_cannot_be_written(folder: Path) -> None:
    result = run("check", "cell.yaml", "--junit", "models")
    assert result.exit_code == 1
    assert "error[output-unwritable]" in result.stderr


def test_usage() -> None:
    assert run("check").exit_code == 2
