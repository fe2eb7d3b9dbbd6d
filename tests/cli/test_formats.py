"""`--output-format`: the same six values for every command that reports diagnostics."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest
from base.test_report_data import check_document
from cli.shell import run

VERBS = [["build"], ["check"], ["plan"], ["tree"], ["lock"], ["fix"], ["fmt", "--check"]]


@pytest.mark.parametrize("verb", VERBS, ids=lambda verb: verb[0])
def test_sarif_is_the_whole_output(folder: Path, verb: list[str]) -> None:
    good = run(*verb, "cell.yaml", "--output-format", "sarif")
    assert check_document(good.stdout) == [] and good.exit_code == 0
    Path("wrong.yaml").write_text("recipe: 1\nbase: ./no.xml\n")
    bad = run(*verb, "wrong.yaml", "--output-format", "sarif")
    if verb[0] != "fmt":
        assert bad.exit_code == 1
        assert [each["ruleId"] for each in check_document(bad.stdout)] == ["source-not-found"]


def test_junit_of_any_command(folder: Path) -> None:
    for verb in ("tree", "check"):
        for recipe, failures in (("cell.yaml", 0), ("wrong.yaml", 1)):
            root = ElementTree.fromstring(run(verb, recipe, "--output-format", "junit").stdout)
            assert root.tag == "testsuites" and len(root.findall(".//failure")) == failures


def test_junit_of_several_recipes_has_a_suite_for_each(folder: Path) -> None:
    root = ElementTree.fromstring(run("check", "cell.yaml", "wrong.yaml", "--output-format", "junit").stdout)
    assert [suite.get("name") for suite in root] == ["cell.yaml", "wrong.yaml"]


def test_markdown(folder: Path) -> None:
    result = run("check", "wrong.yaml", "--output-format", "markdown")
    assert result.stdout.startswith("- `wrong.yaml:5:42`: **error** `attach-place`: the site `flang`")
    assert "\n  - help: did you mean `site: flange`?\n" in result.stdout


def test_a_model_on_standard_output_keeps_it(folder: Path) -> None:
    result = run("build", "cell.yaml", "-o", "-", "--output-format", "sarif")
    assert result.stdout.startswith("<mujoco") and check_document(result.stderr) == []


def test_the_fix_is_exact(folder: Path) -> None:
    (found,) = check_document(run("check", "wrong.yaml", "--output-format", "sarif").stdout)
    assert json.dumps(found["fixes"][0]).count('"flange"') == 1
