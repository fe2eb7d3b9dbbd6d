from __future__ import annotations

import json
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
    result = run("check", "wrong.yaml", "cell.yaml", "nowhere.yaml", "--no-compile")
    assert result.exit_code == 2  # a recipe that does not exist
    assert result.stdout == "cell.yaml: ok\n"
    assert "error[attach-place]" in result.stderr and "error[file-not-found]" in result.stderr


def test_mujoco_is_asked(folder: Path) -> None:
    assert run("check", "rejected.yaml").exit_code == 1
    assert run("check", "rejected.yaml", "--no-compile").exit_code == 0


def test_json_of_a_right_recipe_is_empty(folder: Path) -> None:
    result = run("check", "cell.yaml", "--no-compile", "--output-format", "json")
    assert result.exit_code == 0 and result.stdout == "" and result.stderr == ""


CHECKED = """
check:
  nq: {expect: {attr: nq, equals: 1}}
  have: {expect: {select: {site: flange}}}
"""


def test_checks_are_counted_and_one_that_fails_is_told(folder: Path) -> None:
    recipe = folder / "cell.yaml"
    recipe.write_text(recipe.read_text() + CHECKED)
    assert run("check", "cell.yaml").stdout == "cell.yaml: ok, 2 checks hold\n"
    recipe.write_text(recipe.read_text().replace("equals: 1", "equals: 2"))
    result = run("check", "cell.yaml")
    assert result.exit_code == 1
    assert "error[check-failed]: check `nq`: `nq` of the model is 1, not 2" in result.stderr
    annotated = run("check", "cell.yaml", "--output-format", "github").stdout
    assert annotated.startswith("::error file=cell.yaml,line=10,col=35,")
    assert run("check", "cell.yaml", "--no-compile").exit_code == 0


def cases(text: str) -> dict[str, str | None]:
    """By suite and case, the type of its failure."""
    found: dict[str, str | None] = {}
    for suite in Xml.fromstring(text):
        for case in suite.iter("testcase"):
            failure = case.find("failure")
            found[f"{suite.get('name')} {case.get('name')}"] = None if failure is None else failure.get("type")
    return found


def test_junit(folder: Path) -> None:
    recipe = folder / "cell.yaml"
    recipe.write_text(recipe.read_text() + CHECKED.replace("flange", "flang"))
    result = run("check", "cell.yaml", "wrong.yaml", "--junit", "out/report.xml")
    assert result.exit_code == 1
    assert cases((folder / "out" / "report.xml").read_text(encoding="utf-8")) == {
        "cell.yaml model": None,
        "cell.yaml nq": None,
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


STUDY = """
recipe: 1
name: study
params: {m: 1}
matrix: {axes: {m: [1, 2, 3]}, name: "study-${m}kg"}
add: [{to: world, body: {name: b, geom: [{type: sphere, size: [0.1], mass: "${m}"}]}}]
check: {light: {expect: {attr: mass, range: [0, 1.5]}}}
"""
HEAVY = [{"name": name, "cell": name, "sample": None} for name in ("study-2kg", "study-3kg")]


def test_all_cells_are_checked_and_named(folder: Path) -> None:
    (folder / "study.yaml").write_text(STUDY)
    result = run("check", "study.yaml", "cell.yaml", "--all")
    assert result.exit_code == 1 and result.stdout == "cell.yaml: ok\n"
    assert result.stderr.count("error[check-failed]") == 1
    assert "  = cells: study-2kg, study-3kg\n" in result.stderr and "  = recipe: study.yaml\n" in result.stderr
    assert "study-3kg: check `light`: `mass` of the model is 3 kg, not 0 to 1.5 kg\n" in result.stderr
    assert "1 of 2 recipes failed: study.yaml\n" in result.stderr
    assert "2 of 3 cells failed: study-2kg, study-3kg\n" in result.stderr
    told = list(map(json.loads, run("check", "study.yaml", "--all", "--output-format", "json").stdout.splitlines()))
    assert [each.get("cells") for each in told] == [HEAVY, 3]
    assert told[-1] == {"recipe": "study.yaml", "cells": 3, "failed": HEAVY}
    marks = run("check", "study.yaml", "--all", "--output-format", "github").stdout.splitlines()
    assert "title=check-failed in 2 cells::" in marks[0]
    assert marks[-1] == "::error title=study.yaml::2 of 3 cells failed: study-2kg, study-3kg"
    assert cases(run("check", "study.yaml", "--all", "--junit", "-").stdout) == {
        "study.yaml: study-1kg model": None,
        "study.yaml: study-1kg light": None,
        "study.yaml: study-2kg model": None,
        "study.yaml: study-2kg light": "check-failed",
        "study.yaml: study-3kg model": None,
        "study.yaml: study-3kg light": "check-failed",
    }


def test_a_study_that_is_right(folder: Path) -> None:
    (folder / "study.yaml").write_text(STUDY.replace("1.5", "9"))
    assert run("check", "study.yaml", "--all").stdout == "study.yaml: ok, 3 models, 3 checks hold\n"
    told = run("check", "study.yaml", "--all", "--output-format", "json").stdout
    assert json.loads(told) == {"recipe": "study.yaml", "cells": 3, "failed": []}


def test_picked_cells(folder: Path) -> None:
    (folder / "study.yaml").write_text(STUDY)
    light = run("check", "study.yaml", "--pick", "study-1kg")
    assert (light.exit_code, light.stdout) == (0, "study.yaml: ok, 1 model, 1 check holds\n")
    heavy = run("check", "study.yaml", "--pick", "m=2", "--pick", "study-1kg")
    assert heavy.exit_code == 1 and "1 of 2 cells failed: study-2kg" in heavy.stderr
    for pick, words in (
        ("study-4kg", "the matrix of `study.yaml` has no cell `study-4kg`"),
        ("m=4", "no cell of `study.yaml` has `m` = `4`"),
        ("m=2,x=1", "has no cell `m=2,x=1`"),
    ):
        wrong = run("check", "study.yaml", "--pick", pick)
        assert wrong.exit_code == 2 and words in wrong.stderr
    alone = run("check", "cell.yaml", "--pick", "study-1kg")
    assert alone.exit_code == 2 and "error[missing-key]" in alone.stderr


def test_cells_that_were_not_checked_are_reported(folder: Path) -> None:
    (folder / "study.yaml").write_text(STUDY)
    for _ in range(2):  # the second time from the cache
        result = run("check", "study.yaml")
        assert (result.exit_code, result.stdout) == (0, "study.yaml: ok, 1 check holds\n")
        assert "note[cells-not-checked]: one model was checked, and the matrix has 3 cells" in result.stderr
    assert json.loads(run("check", "study.yaml", "--output-format", "json").stdout)["code"] == "cells-not-checked"
    assert "cells-not-checked" not in run("build", "study.yaml").stderr


CONVERTED = """\
recipe: 1
name: converted
base: ./models/servo.xml
edit:
  - {select: {actuator: a}, convert: {to: motor}}
"""
SERVO = """<mujoco><worldbody><body name="b"><joint name="j"/><geom size="0.1"/></body></worldbody>
  <actuator><position name="a" joint="j" kp="10"/></actuator></mujoco>"""


def test_strict_and_allow(folder: Path) -> None:
    """Also of what is built already, and nothing is written of what has warnings."""
    (folder / "models" / "servo.xml").write_text(SERVO)
    (folder / "w.yaml").write_text(CONVERTED)
    for _ in range(2):
        assert run("check", "w.yaml").exit_code == 0
        result = run("check", "w.yaml", "--strict")
        assert result.exit_code == 1 and "error[convert-loss]" in result.stderr and "ok" not in result.stdout
    assert run("build", "w.yaml", "--strict", "-o", "w.zip").exit_code == 1
    assert not (folder / "w.zip").exists()
    assert run("build", "w.yaml", "-o", "w.zip").exit_code == 0
    (folder / "w.yaml").write_text(CONVERTED.replace("motor}}", "motor}, allow: [convert-loss]}"))
    for _ in range(2):
        result = run("check", "w.yaml", "--strict")
        assert (result.exit_code, result.stderr) == (0, "")


def test_licenses_are_allowed_at_the_top(folder: Path) -> None:
    (folder / "models" / "LICENSE").unlink()
    assert "warning[license-missing]" in run("build", "cell.yaml", "-o", "a.zip").stderr
    result = run("build", "cell.yaml", "-o", "b.zip", "--strict")
    assert result.exit_code == 1 and "error[license-missing]" in result.stderr and not (folder / "b.zip").exists()
    recipe = folder / "cell.yaml"
    recipe.write_text(recipe.read_text() + "allow: [license-missing]\n")
    for _ in range(2):
        result = run("build", "cell.yaml", "-o", "b.zip", "--strict")
        assert (result.exit_code, result.stderr) == (0, "")


def test_verbose_says_stages_and_files(folder: Path) -> None:
    result = run("check", "cell.yaml", "-v")
    assert [line.split()[0] for line in result.stderr.splitlines()][:6] == [
        "plan",
        "compose",
        "bundle",
        "compile",
        "keys",
        "check",
    ]
    assert "  read cell.yaml\n" in result.stderr and "  read models/meshes/cover.obj\n" in result.stderr
    again = run("check", "cell.yaml", "--verbose").stderr
    assert "nothing was built: the cache has it" in again and "  read models/tool.xml\n" in again
    assert "read" not in run("check", "cell.yaml").stderr


def test_several_recipes_at_once(folder: Path) -> None:
    (folder / "bad.xml").write_text('<mujoco><worldbody><body nam="x"/></worldbody></mujoco>')
    for name in ("one", "two"):
        (folder / f"{name}.yaml").write_text("recipe: 1\nbase: ./bad.xml\n")
    names = ["one.yaml", "cell.yaml", "two.yaml"]
    for jobs in ("1", "2"):
        result = run("check", *names, "--jobs", jobs)
        assert result.exit_code == 1 and result.stdout == "cell.yaml: ok\n"
        assert result.stderr.count("error[unknown-attribute]") == 1
        assert "  = recipes: one.yaml, two.yaml\n" in result.stderr
        assert result.stderr.endswith("2 of 3 recipes failed: one.yaml, two.yaml\n")
        told = list(map(json.loads, run("check", *names, "--output-format", "json", "-j", jobs).stdout.splitlines()))
        assert told[0]["recipes"] == ["one.yaml", "two.yaml"]
        assert told[1:] == [{"recipe": each, "ok": each == "cell.yaml"} for each in names]
        marks = run("check", *names, "--output-format", "github", "-j", jobs).stdout
        assert "%0Arecipes: one.yaml, two.yaml" in marks
        assert "::notice title=cell.yaml::cell.yaml: ok" in marks
    assert run("check", "cell.yaml", "--jobs", "2").exit_code == 2
    assert run("check", *names, "--shard", "1/2").exit_code == 2
    missing = run("check", "cell.yaml", "missing.yaml")
    assert missing.exit_code == 2 and "1 of 2 recipes failed: missing.yaml" in missing.stderr
