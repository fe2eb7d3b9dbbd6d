"""`-`: a recipe on standard input, with paths relative to the current folder."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli.shell import RECIPE, WRONG, process, run, snapshot

UNNAMED = RECIPE.replace("name: cell\n", "")


def test_a_build_is_that_of_a_file(folder: Path) -> None:
    assert run("build", "cell.yaml", "-o", "-").stdout == run("build", "-", "-o", "-", input=RECIPE).stdout
    before = snapshot(folder)
    result = run("build", "-", "-o", "out.zip", input=UNNAMED)
    assert result.exit_code == 0 and "model: nq" in result.stdout
    assert snapshot(folder).keys() - before.keys() == {"out.zip"}
    assert run("verify", "out.zip").exit_code == 0
    assert run("build", "-", input=UNNAMED).exit_code == 0
    assert (folder / "build" / "model.zip").is_file()


def test_another_recipe_is_not_taken_from_the_cache(folder: Path) -> None:
    first = run("build", "-", "-o", "-", input=RECIPE).stdout
    second = run("build", "-", "-o", "-", input=RECIPE.replace("  tool:", "  hand:")).stdout
    assert "tool/palm" in first and "hand/palm" in second


@pytest.mark.parametrize("verb", ["build", "check", "tree"])
def test_an_error_has_its_line(folder: Path, verb: str) -> None:
    assert run(verb, "-", input=RECIPE).exit_code == 0
    result = run(verb, "-", input=WRONG)
    assert result.exit_code == 1
    assert result.stderr.startswith("<stdin>:5:42: error[attach-place]")
    assert "  tool: {model: ./models/tool.xml, site: flang}" in result.stderr


def test_explain_names_standard_input(folder: Path) -> None:
    result = run("explain", "-", "sensor angle", "--output-format", "json", input=RECIPE)
    assert result.exit_code == 0 and json.loads(result.stdout)["label"] == "jointpos angle"


def test_cells_are_made_in_this_process(folder: Path) -> None:
    recipe = RECIPE + "params: {size: 0.1}\nmatrix: {axes: {size: [0.1, 0.2]}}\n"
    result = run("build", "-", "--all", "--jobs", "2", "-o", "out/{name}.zip", input=recipe)
    assert result.exit_code == 0, result.stderr
    assert len(list((folder / "out").glob("*.zip"))) == 2


def test_what_needs_a_file_says_so(folder: Path) -> None:
    result = run("check", "-", "cell.yaml", input=RECIPE)
    assert result.exit_code == 2 and "`-`, is checked alone" in result.stderr
    result = run("check", "-", "--locked", input=RECIPE)
    assert result.exit_code == 1 and "standard input has no lock" in result.stderr
    result = run("build", "-", "--all", "--cluster", "local", input=RECIPE)
    assert result.exit_code == 2 and "cannot read standard input" in result.stderr
    assert run("fix", "-", input=WRONG).exit_code == 2
    assert run("check", "-", input="").stderr.startswith("<stdin>:1:1: error[yaml-empty]")


def test_a_process_reads_its_standard_input(folder: Path) -> None:
    done = process("check", "-", "--output-format", "json", input=WRONG.encode())
    assert json.loads(done.stdout)["span"]["file"] == "<stdin>" and done.returncode == 1
    done = process("check", "-", input=b"\xff\xfe\x00recipe")
    assert done.returncode == 1 and b"error[yaml-" in done.stderr


def test_a_text_without_end_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = run("check", "-", "--limit", "recipe-size=100", input="#" * 1000)
    assert result.exit_code == 1 and "error[yaml-too-large]" in result.stderr
