from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli.shell import RECIPE, REPOSITORY, run
from jsonschema import Draft202012Validator

ADDED = "add:\n  - {to: link, geom: {type: sphere, size: ['${0.1 * size}']}}\n"


@pytest.mark.parametrize("arguments", [[], ["recipe"], ["manifest"], ["diagnostics"]])
def test_schema_is_that_of_the_repository(arguments: list[str]) -> None:
    file = REPOSITORY / "schemas" / f"{(arguments or ['recipe'])[0]}.schema.json"
    if not file.exists():
        pytest.skip(f"{file.name} does not exist")
    result = run("schema", *arguments)
    assert result.exit_code == 0 and result.stderr == ""
    assert result.stdout == file.read_text(encoding="utf-8")
    assert json.loads(result.stdout)["$schema"].startswith("https://json-schema.org/")


def test_usage() -> None:
    assert run("schema", "model").exit_code == 2


WORDS = {
    "diagnostic": [["check", "wrong.yaml"], ["build", "wrong.yaml"], ["plan", "no.yaml"]],
    "build": [["build", "cell.yaml"], ["build", "cell.yaml", "--no-compile", "-o", "out/", "--licenses", "--why"]],
    "check": [["check", "cell.yaml", "wrong.yaml"]],
    "cells": [["check", "matrix.yaml", "--all"], ["build", "matrix.yaml", "--all"]],
}


@pytest.mark.parametrize("kind", WORDS)
def test_real_lines_are_of_the_schema(kind: str, folder: Path) -> None:
    whole = json.loads((REPOSITORY / "schemas" / "diagnostics.schema.json").read_text(encoding="utf-8"))
    check = Draft202012Validator(whole)
    results = {each["title"]: each for each in whole["$defs"]["result"]["anyOf"]}
    own = {**whole, **(whole["$defs"][kind] if kind == "diagnostic" else results[kind])}
    for name in ("if", "then", "else"):
        own.pop(name)
    (folder / "matrix.yaml").write_text("matrix: {axes: {size: [1, -1]}}\nparams: {size: 1}\n" + RECIPE + ADDED)
    for arguments in WORDS[kind]:
        lines = [json.loads(line) for line in run(*arguments, "--output-format", "json").stdout.splitlines()]
        assert lines
        for line in lines:
            check.validate(line)
        assert any(Draft202012Validator(own).is_valid(line) for line in lines), lines
        assert all(("severity" in line) == ("code" in line) for line in lines)


def test_a_line_of_another_shape_is_not(folder: Path) -> None:
    check = Draft202012Validator(json.loads(run("schema", "diagnostics").stdout))
    (found,) = (json.loads(line) for line in run("check", "wrong.yaml", "--output-format", "json").stdout.splitlines())
    assert check.is_valid(found) and found["fix"] is not None
    for change in ({"severity": "fatal"}, {"span": {"file": "a"}}, {"cells": ["a"]}, {"fix": "flange"}):
        assert not check.is_valid({**found, **change})
    del found["help"]
    assert not check.is_valid(found)
